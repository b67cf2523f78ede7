#include <fmt/format.h>

#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/review_recording.h"
#include "app/live/shown_review.h"
#include "app/recording/replay_session.h"
#include "planning_io/case/case_folder.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;

/// What else is known of that session, a line each.
std::vector<std::string> left_of(const Path& recording, const Path& case_folder) {
    std::vector<std::string> left;
    std::error_code ignored;
    for (const char* ending : {".html", ".json", ".pdf"})
        if (const Path report = Path(recording).replace_extension(ending); fs::exists(report, ignored))
            left.push_back(report.string() + " (its report)");
    if (const Path review = review_folder_of(recording); fs::exists(review, ignored))
        left.push_back(review.string() + " (its review: pictures that show the face)");
    const Path stem = Path(recording).replace_extension("");
    std::error_code unknown;
    for (fs::directory_iterator entry(stem.parent_path().empty() ? Path(".") : stem.parent_path(), unknown), end;
         !unknown && entry != end; entry.increment(unknown))
        if (entry->path().filename().string().starts_with(stem.filename().string() + kSnapshotAt))
            left.push_back((stem.parent_path() / entry->path().filename()).string() + " (a picture of its review)");
    if (case_folder.empty()) return left;
    if (const Path matches = case_folder / kRegistrationsFolder; fs::exists(matches, ignored))
        left.push_back(matches.string() + " (matches with scans of the skin, of all sessions)");
    if (fs::exists(case_folder, ignored)) left.push_back(case_folder.string() + " (the case)");
    return left;
}

/// The case that it names; empty where it cannot be read.
Path case_of(const Path& recording) {
    try {
        if (const Path said = head_of_recording(recording).case_folder; !said.empty()) return said;
    } catch (const DamagedFileError&) {  // a recording all the same: its first words are
    } catch (const DiskError&) {         // what cannot be read can be removed all the same
    }
    // Without names in it, it says no case; where it lies usually does.
    const Path folder = std::filesystem::absolute(recording).parent_path();
    return folder.filename() == "recordings" ? folder.parent_path() : Path();
}

/// False: somebody has removed it already.
bool removed(const Path& file) {
    std::error_code fault;
    const bool was_there = fs::remove(file, fault);
    if (fault) throw DiskError(file, "cannot be removed: " + fault.message(), "Check the permissions of its folder.");
    return was_there;
}

/// Of a link, what it leads to is removed first: there the faces are.
int run_forget(const Path& named) {
    const Path case_folder = case_of(named);
    std::error_code ignored;
    const bool link = fs::is_symlink(named, ignored);
    const Path recording = link ? fs::canonical(named) : named;
    const std::uintmax_t names = fs::hard_link_count(recording, ignored);
    const bool others = !ignored && names > 1;
    fmt::print("{} is removed{}.\n", recording.string(), removed(recording) ? "" : " already");
    if (link && removed(named)) fmt::print("{}, a link to it, is removed.\n", named.string());
    const auto left = left_of(recording, case_folder);
    if (others)
        fmt::print("Left: the recording itself, under {} other name{} (hard links)\n", names - 1, names > 2 ? "s" : "");
    for (const std::string& what : left) fmt::print("Left: {}\n", what);
    fmt::print(
        "Left: matches of it where `session --keep` said another folder, copies that somebody made, and until the disk "
        "writes over them the bytes themselves, unless it is "
        "encrypted.\n");
    return 0;
}

}  // namespace

Run add_forget(CLI::App& app) {
    const auto recording = std::make_shared<Path>();
    auto* sub = add_command(app, "forget", "Removes the recording of a session, and says what is left of it",
                            "forget case/recordings/2026-03-14T09-30-00Z.plrec");
    sub->add_option("recording", *recording, "Recording of a session")->required();
    return [recording] { return run_forget(*recording); };
}

}  // namespace planlight
