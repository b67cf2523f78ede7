#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "planning_io/files/memory_need.h"
#include "planning_io/files/sandboxed_process.h"
#include "planning_io/types/error.h"
#include "planning_io/volume/volume_in_child.h"
#include "tests/support/sanitizer.h"

namespace planlight {
namespace {

template <class Thrown>
std::string refusal_of(const std::function<Volume()>& parse) {
    try {
        volume_in_child("some/file.dcm", parse);
    } catch (const Thrown& e) {
        EXPECT_FALSE(e.remedy.empty());
        return e.what();
    }
    return "";
}

double children_processor_s() {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

bool says(const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
}

TEST(LimitedChild, AVolumeComesThroughWhole) {
    Volume made;
    made.size = {3, 2, 2};
    made.values = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, -12.5F};
    made.ct_from_voxel = Eigen::Translation3d(1, 2, 3) * Eigen::Scaling(0.5, 0.6, 0.7);
    made.modality = "CT";
    made.is_hu = true;
    made.notes = {"one", "two"};
    const Volume got = volume_in_child("file", [&] { return made; });
    EXPECT_EQ(got.values, made.values);
    EXPECT_EQ(got.size, made.size);
    EXPECT_EQ(got.notes, made.notes);
    EXPECT_TRUE(got.ct_from_voxel.isApprox(made.ct_from_voxel, 0));
}

TEST(LimitedChild, ACrashAHangAndAGreedyParserCostTheChildOnly) {
    if (test::kUnderASanitizer) GTEST_SKIP() << "no limit means anything";
    EXPECT_TRUE(says(refusal_of<DamagedFileError>([]() -> Volume { std::abort(); }), "crash (signal 6)"));
    EXPECT_TRUE(says(refusal_of<DamagedFileError>([]() -> Volume {
                         raise(SIGSEGV);
                         return {};
                     }),
                     "crash (signal 11)"));
    const double before_s = children_processor_s();
    EXPECT_TRUE(says(refusal_of<DamagedFileError>([]() -> Volume {
                         for (volatile int spin = 0;;) spin = spin + 1;
                     }),
                     "took longer"))
        << "after a second of processor";
    EXPECT_LT(children_processor_s() - before_s, 2)
        << "the limit is 1 s of processor, whatever the clock on the wall says";
    const bool has_enough = free_memory_bytes() > (std::uint64_t{5} << 30);  // for what a child may take at most
    try {
        volume_in_child("some/file.dcm", []() -> Volume {
            Volume v;
            v.values.resize(std::size_t{5} << 28);
            return v;
        });
        ADD_FAILURE() << "took 5 GiB";
    } catch (const Error& e) {
        EXPECT_TRUE(says(e.what(), "MiB that it may have")) << e.what();
        if (has_enough) {
            EXPECT_EQ(e.exit_code, ExitCode::input_refused) << "the file is too large, whatever the machine has";
        }
    }
    EXPECT_TRUE(says(refusal_of<DamagedFileError>([]() -> Volume { _exit(0); }), "to its end"));
}

TEST(LimitedChild, AnErrorOfTheParserComesThroughWithItsRemedy) {
    try {
        volume_in_child("file", []() -> Volume { throw InputError("a.dcm", "has a gap", "Export it again."); });
        FAIL();
    } catch (const InputError& e) {
        EXPECT_STREQ(e.what(), "a.dcm: has a gap");
        EXPECT_EQ(e.remedy, "Export it again.");
    }
}

TEST(LimitedChild, AnErrorKeepsItsExitCode) {
    for (const ExitCode code : {ExitCode::disk, ExitCode::input_refused, ExitCode::file_damaged, ExitCode::our_fault})
        try {
            volume_in_child("a.nii", [=]() -> Volume { throw Error(code, "a.nii: is too much", "Do less."); });
            FAIL();
        } catch (const Error& e) {
            EXPECT_EQ(e.exit_code, code);
            EXPECT_STREQ(e.what(), "a.nii: is too much");
            EXPECT_EQ(e.remedy, "Do less.");
        }
}

/// Less memory than any file may take is the machine's lack, more than that the file's size.
TEST(LimitedChild, WhereMemoryIsShortTheFileIsNotAtFault) {
    if (test::kUnderASanitizer) GTEST_SKIP() << "no limit means anything";
    const auto read_with_little = [] {
        unsigned long pages = 0;
        if (std::FILE* status = std::fopen("/proc/self/statm", "r"); status && std::fscanf(status, "%lu", &pages) == 1)
            std::fclose(status);
        const rlim_t most = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (rlim_t{300} << 20);
        const rlimit both{most, most};
        setrlimit(RLIMIT_AS, &both);
        try {
            volume_in_child("a.nii", []() -> Volume {
                Volume v;
                v.values.resize(std::size_t{100} << 20);  // 400 MiB
                return v;
            });
        } catch (const Error& e) {
            std::fprintf(stderr, "%s", e.what());
            std::exit(static_cast<int>(e.exit_code));
        }
        std::exit(0);
    };
    EXPECT_EXIT(read_with_little(), ::testing::ExitedWithCode(static_cast<int>(ExitCode::disk)),
                "needs more memory to be read than the .* MiB");
}

TEST(LimitedChild, AParcelGivesBackWhatWasPutAndNoMore) {
    Parcel parcel = parse_in_child("file", {}, [](Parcel& to) {
        to.put(3.5);
        to.put(std::string("text"));
        to.put(std::vector<int>{1, 2, 3});
        to.put(std::string());
    });
    EXPECT_EQ(parcel.get<double>(), 3.5);
    EXPECT_EQ(parcel.get_text(), "text");
    EXPECT_EQ(parcel.get_list<int>(), (std::vector<int>{1, 2, 3}));
    EXPECT_EQ(parcel.get_text(), "");
    EXPECT_EQ(parcel.left(), 0u);
    EXPECT_THROW(parcel.get<char>(), std::out_of_range);
    Parcel lying = parse_in_child("file", {}, [](Parcel& to) { to.put(std::uint64_t{1} << 60); });
    EXPECT_THROW(lying.get_list<double>(), std::out_of_range);  // says that it is longer than it is
}

TEST(LimitedChild, AParcelHalfPutIsGoneWhenTheParserThrows) {
    const auto parse = [](Parcel& to) {
        to.put(std::vector<double>(100000, 1.5));
        throw InputError("a.dcm", "has a gap", "Export it again.");
    };
    try {
        parse_in_child("file", {}, parse);
        FAIL();
    } catch (const InputError& e) {
        EXPECT_STREQ(e.what(), "a.dcm: has a gap");
    }
}

}  // namespace
}  // namespace planlight
