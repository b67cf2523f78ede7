#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/archive_options.h"
#include "app/commands/commands.h"
#include "app/console.h"
#include "app/json_text.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

struct StoreOptions {
    ArchiveOptions archive;
    std::vector<Path> from;
    bool json = false;
};

/// The files that are named, and those of the folders that are.
std::vector<fs::path> files_of(const std::vector<Path>& from) {
    std::vector<fs::path> files;
    for (const Path& path : from) {
        std::error_code fault;
        if (!fs::is_directory(path, fault)) {
            files.push_back(path);
            continue;
        }
        const std::size_t before = files.size();
        for (const auto& entry : fs::directory_iterator(path))
            if (entry.is_regular_file(fault)) files.push_back(entry.path());
        if (files.size() == before)
            throw InputError(path, "holds no file", "Name the folder that `planlight export` wrote.");
    }
    std::sort(files.begin(), files.end());
    return files;
}

int run_store(const StoreOptions& options) {
    const DicomPeer archive = archive_of(options.archive);
    const std::vector<fs::path> files = files_of(options.from);
    std::vector<std::string> said;
    {
        ProgressBar bar;
        said = store_objects(archive, files, [&](std::size_t done, std::size_t of) {
            bar.show("store", static_cast<double>(done) / static_cast<double>(of));
        });
    }
    for (const std::string& what : said) warn(what);
    if (options.json)
        std::cout << json_text(nlohmann::ordered_json{
                         {"archive", archive.name()}, {"stored", files.size()}, {"warnings", said}})
                  << '\n';
    else
        fmt::print("{} took {} objects.\n", archive.name(), files.size());
    return 0;
}

}  // namespace

Run add_store(CLI::App& app) {
    const auto options = std::make_shared<StoreOptions>();
    StoreOptions& o = *options;
    auto* sub = add_command(app, "store", "Send DICOM objects (of `export`) to an archive (PACS)", "store for-pacs");
    sub->add_option("from", o.from, "Folder of DICOM objects, or files")->required();
    archive_options(sub, o.archive);
    json_flag(sub, o.json);
    return [options] { return run_store(*options); };
}

}  // namespace planlight
