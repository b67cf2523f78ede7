// How soon an hour's recording is shown, and its last match found: the updates and frames of a short session are
// written again and again, later each time, until they make an hour. Each step begins with nothing of the file in
// memory. measure_review [MINUTES] [all]; `all`: with every frame, as `session --record all` keeps them (0.4 GB a
// minute)
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "app/live/review_desk.h"
#include "app/recording/resume_offer.h"
#include "app/report/recorded_moments.h"
#include "app/report/recording_review.h"
#include "planning_io/recording/recording_reader.h"
#include "tests/app/played_session.h"
#include "tests/support/test_data.h"

namespace {

using namespace planlight;
namespace fs = std::filesystem;

double elapsed_s(std::chrono::steady_clock::time_point since) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - since).count();
}

/// The event with its time on the session's clock so much later.
std::string later(const std::string& text, Instant by) {
    const std::size_t at = text.find("\"at_ns\":");
    if (at == std::string::npos) return text;
    const std::size_t from = at + 8, end = text.find_first_not_of("-0123456789", from);
    return text.substr(0, from) + std::to_string(std::stoll(text.substr(from, end - from)) + by.count()) +
           text.substr(end);
}

/// The system forgets what it has of the file: the next to read it waits for the disk.
void forget(const fs::path& file) {
    const int opened = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (opened < 0) return;
    ::fsync(opened);
    ::posix_fadvise(opened, 0, 0, POSIX_FADV_DONTNEED);
    ::close(opened);
}

}  // namespace

int main(int argc, char** argv) {
    const double minutes = argc > 1 ? std::stod(argv[1]) : 60;
    const bool all = argc > 2 && std::string(argv[2]) == "all";
    if (!test::example_case().there) return 77;
    const test::TemporaryFolder folder;
    const fs::path brief = folder.path() / "brief.plrec", file = folder.path() / "long.plrec";
    test::PlayedSession how;
    how.updates = 150;
    test::record_session(how, test::example_case(), all ? RecordMode::all : RecordMode::events, brief);
    std::vector<RecordingChunk> head, body;
    RecordingReader reader(brief);
    while (auto chunk = reader.next()) {
        const bool following = !body.empty() || chunk->payload.starts_with(R"({"what":"updated")");
        if (chunk->type != chunk_types::kDone) (following ? body : head).push_back(std::move(*chunk));
    }
    const Instant lasts = body.back().at - body.front().at;
    std::ofstream out(file, std::ios::binary);
    out << recording_header();
    std::uint64_t number = 0;
    for (const auto& chunk : head) out << chunk_bytes(chunk, number++);
    // Frames as an hour within its budget has them: one every two seconds, and twelve round each event.
    for (Instant by{}; seconds(by) < 60 * minutes; by += lasts) {
        int frames = 0;
        for (const auto& chunk : body) {
            if (!all && chunk.type == chunk_types::kFrame && ++frames > 0.7 * seconds(lasts)) continue;
            out << chunk_bytes({chunk.type, chunk.at + by,
                                chunk.type == chunk_types::kEvent ? later(chunk.payload, by) : chunk.payload},
                               number++);
        }
    }
    out.close();
    forget(file);
    auto began = std::chrono::steady_clock::now();
    RecordingTimeLine line = time_line_of(file);
    const double read_s = elapsed_s(began);
    const std::string page = review_page(line, {});
    const double page_s = elapsed_s(began);
    forget(file);
    began = std::chrono::steady_clock::now();
    look_at_pictures(line, file);
    const double look_s = elapsed_s(began);
    forget(file);
    began = std::chrono::steady_clock::now();
    RecordedMoments moments(file, line);
    const bool pictures = !moments.moment(line.frames_s.size() - 1).frame.left.empty();
    const double frame_s = elapsed_s(began);
    began = std::chrono::steady_clock::now();
    forget(file);
    double first_picture_s = 0, desk_s = 0;
    {
        ReviewDesk desk(file, folder.path() / "no-case", line.lasted_s / 2);
        for (; desk_s == 0; std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
            const auto model = desk.model();
            if (first_picture_s == 0 && model->cameras[0].picture) first_picture_s = elapsed_s(began);
            if (model->settled) desk_s = elapsed_s(began);
        }
    }
    forget(file);
    began = std::chrono::steady_clock::now();
    const bool match = last_match_of(file).match.has_value();
    fmt::print(
        "{:.1f} min, {:.2f} GB, {} chunks, {} frames: time line {:.2f} s, with its page ({:.0f} kB) {:.2f} s, all its "
        "pictures looked at {:.2f} s; the last "
        "frame ({}) {:.3f} s; its window has a first picture after {:.2f} s, and the middle of the hour after {:.2f} "
        "s; the "
        "last match ({}) {:.2f} s\n",
        line.lasted_s / 60, static_cast<double>(fs::file_size(file)) / 1e9, number, line.frames_s.size(), read_s,
        static_cast<double>(page.size()) / 1e3, page_s, look_s, pictures ? "read" : "empty", frame_s, first_picture_s,
        desk_s, match ? "found" : "none", elapsed_s(began));
    return 0;
}
