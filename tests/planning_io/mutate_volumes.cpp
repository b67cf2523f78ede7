#include "tests/planning_io/mutate_volumes.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include "planning_io/files/safe_write.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/read_volume.h"
#include "tests/planning_io/synthetic_files.h"
#include "tests/planning_io/volume_cases.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;

/// A sound volume, and the file of it that is damaged in each mutation.
struct Seed {
    fs::path give, damage;
    std::string whole;
    std::size_t header = 0;  ///< bytes in which most damage is done
};

std::vector<Seed> seeds_in(const fs::path& folder) {
    std::vector<Seed> seeds;
    int number = 0;
    for (const auto& c : sound_volumes()) {
        static const char* kKinds[] = {"DICOM, explicit little endian",
                                       "DICOM, implicit little endian",
                                       "DICOM, explicit big endian",
                                       "DICOM, deflated",
                                       "DICOM, RLE",
                                       "DICOM, JPEG lossless",
                                       "DICOM, JPEG-LS",
                                       "DICOM, JPEG 2000",
                                       "DICOM, Enhanced CT, frames shuffled",
                                       "NIfTI, sform",
                                       "NIfTI, gzip, left-handed axes",
                                       "NRRD, raw",
                                       "NRRD, gzip",
                                       "MetaImage",
                                       "MetaImage, packed, left-handed axes, AnatomicalOrientation LAI"};
        if (std::find(std::begin(kKinds), std::end(kKinds), c.name) == std::end(kKinds)) continue;
        const fs::path place = folder / std::to_string(number++);
        fs::create_directories(place);
        Seed& seed = seeds.emplace_back();
        seed.give = seed.damage = c.make(place);
        if (fs::is_directory(seed.give))
            for (const auto& entry : fs::directory_iterator(place))
                if (seed.damage == seed.give || entry.path() > seed.damage) seed.damage = entry.path();
    }
    seeds.push_back({folder / "head.inv3", folder / "head.inv3", "", 0});
    write_invesalius_project(seeds.back().give);
    for (Seed& seed : seeds) {
        seed.whole = read_whole(seed.damage);
        seed.header = std::min<std::size_t>(seed.whole.size(), 1200);
    }
    return seeds;
}

std::string mutated(const Seed& seed, std::mt19937& random) {
    std::string bytes = seed.whole;
    const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
    const auto place = [&] { return below(below(4) != 0 ? std::min(seed.header, bytes.size()) : bytes.size()); };
    const std::size_t count = std::size_t{1} << below(6);
    switch (below(7)) {
        case 0:
            for (std::size_t n = 0; n < count; ++n) {
                char& c = bytes[place()];
                c = static_cast<char>(c ^ (1 << below(8)));
            }
            break;
        case 1:
            for (std::size_t n = 0; n < count; ++n) bytes[place()] = static_cast<char>(below(256));
            break;
        case 2:
            bytes.resize(below(bytes.size()));
            break;
        case 3: {
            const std::size_t at = place();
            bytes.erase(at, count);
        } break;
        case 4: {
            const std::size_t at = place();
            bytes.insert(at, bytes.substr(at, count));
        } break;
        case 5: {
            const std::size_t at = place();
            for (std::size_t n = 0; n < 4 && at + n < bytes.size(); ++n)
                bytes[at + n] = static_cast<char>(below(2) ? 0xff : 0x7f);
        } break;
        default: {
            const std::size_t a = place(), b = place();
            for (std::size_t n = 0; n < count && std::max(a, b) + n < bytes.size(); ++n)
                std::swap(bytes[a + n], bytes[b + n]);
        } break;
    }
    return bytes;
}

double children_processor_s() {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    const auto s = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return s(usage.ru_utime) + s(usage.ru_stime);
}

/// Every file and its time of change: reading must leave them alone.
std::map<fs::path, fs::file_time_type> state_of(const fs::path& folder) {
    std::map<fs::path, fs::file_time_type> files;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) files[entry.path()] = entry.last_write_time();
    return files;
}

void read_one(const Seed& seed, MutationCounts& counts) {
    try {
        read_volume(seed.give);
        ++counts.read;
    } catch (const Error& e) {
        const std::string what = e.what();
        const auto crash = what.find("made the reader of a volume crash");
        counts.parser_crashes += crash != std::string::npos;
        if (crash != std::string::npos) ++counts.crash_kinds[what.substr(what.find('(', crash))];
        counts.cut_off += what.find("took longer") != std::string::npos || what.find("MiB") != std::string::npos;
        ++(e.exit_code == ExitCode::input_refused  ? counts.refused
           : e.exit_code == ExitCode::file_damaged ? counts.damaged
                                                   : counts.other_errors);
        if (e.remedy.empty() || what.empty())
            ++counts.not_an_error, counts.faults.push_back("no sentence for " + seed.give.string());
    } catch (const std::exception& e) {
        ++counts.not_an_error;
        counts.faults.push_back(e.what());
    }
}

}  // namespace

MutationCounts mutate_volumes(int mutations, unsigned seed) {
    const TemporaryFolder folder;
    const auto seeds = seeds_in(folder.path());
    std::mt19937 random(seed);
    MutationCounts counts;
    for (int n = 0; n < mutations; ++n) {
        const Seed& of = seeds[static_cast<std::size_t>(n) % seeds.size()];
        const std::string bytes = mutated(of, random);
        std::ofstream(of.damage, std::ios::binary | std::ios::trunc) << bytes;
        const auto before = state_of(folder.path());
        const double processor = children_processor_s();
        const auto began = std::chrono::steady_clock::now();
        read_one(of, counts);
        const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
        const double spent_s = children_processor_s() - processor;
        counts.most_wall_s = std::max(counts.most_wall_s, wall_s);
        counts.most_processor_s = std::max(counts.most_processor_s, spent_s);
        counts.processor_s += spent_s;
        counts.slow += spent_s > kSlowProcessor_s + 0.2;
        counts.changed_files += state_of(folder.path()) != before;
        ++counts.mutations;
        std::ofstream(of.damage, std::ios::binary | std::ios::trunc) << of.whole;
    }
    return counts;
}

}  // namespace planlight::test
