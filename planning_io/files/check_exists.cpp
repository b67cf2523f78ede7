#include "planning_io/files/check_exists.h"

#include <deque>
#include <optional>
#include <system_error>
#include <vector>

#include "planning_io/types/error.h"

namespace planlight {

namespace fs = std::filesystem;

namespace {

/// Where the way to a file ends early, and why.
struct WaysEnd {
    std::error_code fault;    ///< as the system says it; none: the way is open to its end
    fs::path folder;          ///< the last one that was reached, without links
    fs::path link, leads_to;  ///< the link that the next step stands in; empty: it stands in the name itself
};

/// A link that is being followed: done when only so many steps are left.
struct FollowedLink {
    fs::path link, leads_to;
    std::size_t left;
};

/// The way step by step, links followed as the system follows them.
WaysEnd walk(const fs::path& path) {
    constexpr std::size_t kMostLinks = 40;  // as Linux
    WaysEnd end;
    std::deque<fs::path> steps;
    const auto go_by = [&](const fs::path& way) {
        if (way.is_absolute()) end.folder = way.root_path();
        const fs::path relative = way.relative_path();
        steps.insert(steps.begin(), relative.begin(), relative.end());
    };
    std::error_code ignored;
    go_by(fs::absolute(path, ignored));
    std::vector<FollowedLink> links;
    std::size_t followed = 0;
    while (!steps.empty()) {
        const fs::path step = steps.front(), next = end.folder / step;
        steps.pop_front();
        while (!links.empty() && steps.size() < links.back().left) links.pop_back();
        const fs::file_status there = fs::symlink_status(next, end.fault);
        if (fs::is_symlink(there) && ++followed > kMostLinks)
            end.fault = std::make_error_code(std::errc::too_many_symbolic_link_levels);
        if (end.fault) {
            if (!links.empty()) end.link = links.back().link, end.leads_to = links.back().leads_to;
            return end;
        }
        if (fs::is_symlink(there)) {
            links.push_back({next, fs::read_symlink(next, ignored), steps.size()});
            go_by(links.back().leads_to);
        } else if (step == "..") {
            end.folder = end.folder.parent_path();
        } else if (!step.empty() && step != ".") {
            end.folder = next;
        }
    }
    return end;
}

}  // namespace

void check_exists(const fs::path& path, const std::string& remedy) {
    if (path.empty()) throw InputError({}, "the name of a file or folder is empty", remedy);
    std::error_code fault;
    const fs::file_status there = fs::status(path, fault);
    if (fs::exists(there)) return;
    const WaysEnd end = walk(path);
    if (fault == std::errc::permission_denied)
        throw InputError(path, "cannot be reached: the folder " + end.folder.string() + " may not be entered",
                         "Ask its owner for the permission, or copy the file to a folder of your own.");
    if (there.type() != fs::file_type::not_found)
        throw InputError(path, "cannot be reached: " + fault.message(), "Check the name and the disk it is on.");
    if (end.link.empty()) throw InputError(path, "does not exist", remedy);
    std::error_code ignored;
    const bool itself = end.link.filename() == path.filename() && fs::is_symlink(path, ignored) &&
                        fs::read_symlink(path, ignored) == end.leads_to;
    if (itself)
        throw InputError(path, "is a link to " + end.leads_to.string() + ", which does not exist",
                         "Name the file itself.");
    throw InputError(
        path, "leads over the link " + end.link.string() + " to " + end.leads_to.string() + ", which does not exist",
        "Name the file itself.");
}

}  // namespace planlight
