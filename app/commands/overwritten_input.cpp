#include "app/commands/overwritten_input.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

namespace planlight {
namespace {

namespace fs = std::filesystem;

struct Named {
    std::string option;  ///< as a person writes it
    fs::path path;
};

/// `--surface` is written by `scan` and read by `prepare`.
bool is_written(const CLI::App& command, const std::string& option) {
    static constexpr std::array kWritten{"--out",     "--raw", "--certificate", "--slicer",  "--screenshot",
                                         "--picture", "--pdf", "--dicom",       "--log-file"};
    return std::find(kWritten.begin(), kWritten.end(), option) != kWritten.end() ||
           (option == "--surface" && command.get_name() == "scan");
}

const char* what_becomes_of(const std::string& option) {
    return option == "--log-file" ? "spoilt by lines of a log" : "written over";
}

/// Not a number, nor a word of a few that it may be: "modern" of --preset is no folder of that name.
bool may_be_path(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    return type.starts_with("TEXT") && type.find('{') == std::string::npos;
}

/// One file or folder, whatever it is called.
bool same(const fs::path& a, const fs::path& b) {
    std::error_code error;
    if (fs::exists(a, error) && fs::exists(b, error) && fs::equivalent(a, b, error)) return true;
    const fs::path whole_a = fs::weakly_canonical(a, error), whole_b = fs::weakly_canonical(b, error);
    return !error && whole_a == whole_b;
}

/// What the folders that Planlight writes are made of.
bool is_own_file_of(const fs::path& file, const fs::path& folder) {
    static constexpr std::array kOwn{"case.json",    "checksums.xxh128", "plan.mrk.json", "skin.lut",
                                     "skin.ply",     "report.html",      "report.pdf",    "report.json",
                                     "capture.json", "frames.json",      "light.json"};
    std::error_code error;
    const std::string name = file.filename().string();
    if (!fs::is_directory(folder, error) || !fs::exists(file, error)) return false;
    if (same(file.parent_path().empty() ? "." : file.parent_path(), folder))
        return std::find(kOwn.begin(), kOwn.end(), name) != kOwn.end();
    for (const char* pictures : {"left", "right"})
        if (same(file.parent_path(), folder / pictures)) return true;
    return false;
}

/// A file that a case is made of, whether or not the command reads that case.
bool is_of_a_case(const fs::path& file) {
    const fs::path folder = file.parent_path().empty() ? "." : file.parent_path();
    std::error_code error;
    return fs::exists(folder / "case.json", error) && fs::exists(folder / "checksums.xxh128", error) &&
           is_own_file_of(file, folder);
}

}  // namespace

std::string overwritten_input(const CLI::App& command) {
    std::vector<Named> written, read;
    for (const CLI::Option* option : command.get_options()) {
        if (option->get_expected_max() == 0 || !may_be_path(*option)) continue;
        const bool named = !option->get_lnames().empty();
        const std::string name = named ? "--" + option->get_lnames().front() : option->get_name();
        for (const std::string& text : option->results())
            if (!text.empty()) (named && is_written(command, name) ? written : read).push_back({name, text});
    }
    for (std::size_t i = 0; i < written.size(); ++i) {
        const auto& [option, path] = written[i];
        for (const Named& other : read) {
            std::error_code error;
            if (!fs::exists(other.path, error)) continue;
            if (same(path, other.path))
                return fmt::format("{} names {}, which is read ({}): it would be {}. Give it another name.", option,
                                   path.string(), other.option, what_becomes_of(option));
            if (is_own_file_of(path, other.path))
                return fmt::format("{} names {}, a file that {} ({}) is made of: it would be {}. Give it another name.",
                                   option, path.string(), other.path.string(), other.option, what_becomes_of(option));
        }
        if (command.get_name() != "prepare" && is_of_a_case(path))  // that one makes the whole case anew
            return fmt::format(
                "{} names {}, a file that the case in its folder is made of: it would be {}. Give it "
                "another name.",
                option, path.string(), what_becomes_of(option));
        for (std::size_t k = 0; k < i; ++k)
            if (same(path, written[k].path))
                return fmt::format("{} and {} name the same file, {}. Give each its own name.", written[k].option,
                                   option, path.string());
    }
    return {};
}

}  // namespace planlight
