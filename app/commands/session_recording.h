#pragma once

#include <functional>
#include <memory>

#include "app/commands/session_options.h"
#include "app/live/live_window.h"
#include "app/recording/session_recorder.h"
#include "app/report/report_beside.h"
#include "app/site_settings.h"

namespace planlight {

/// The recording of a session, and at its end the report beside it. Both are ended however the session ends, but for a
/// kill; what they lack is said.
class RecordedSession {
public:
    RecordedSession() = default;
    RecordedSession(std::unique_ptr<SessionRecorder> recorder, Path file, bool report, bool anonymous)
        : recorder_(std::move(recorder)), file_(std::move(file)), report_(report), anonymous_(anonymous) {}
    ~RecordedSession() { end({}, {}, {}); }
    RecordedSession(const RecordedSession&) = delete;
    RecordedSession& operator=(const RecordedSession&) = delete;
    SessionRecorder* get() const { return recorder_.get(); }  ///< null: nothing is recorded
    PatientRecorded of_patient() const {
        return !recorder_ ? PatientRecorded::no : anonymous_ ? PatientRecorded::blurred : PatientRecorded::with_face;
    }

    /// While the window says so; who closes it once more does not wait for the report.
    void end(SessionWindow& window);

private:
    /// Does it while the window is alive; empty: there is no window.
    template <class Made>
    using Meanwhile = std::function<Made(const std::function<Made()>&)>;
    using Closed = std::function<bool()>;
    void end(const Meanwhile<std::string>& finishing, const Meanwhile<ReportBeside>& reporting,
             const Closed& closed) noexcept;
    /// A signal ends it as closing the window does; the one that ended the session does not.
    void report(const Meanwhile<ReportBeside>& meanwhile, const Closed& closed) noexcept;

    std::unique_ptr<SessionRecorder> recorder_;
    Path file_;
    bool report_ = false, anonymous_ = false;
};

/// The recording of this session, said where and how much; none with `--record none`. Throws InputError, DiskError.
RecordedSession recording_of_session(const SessionOptions& options, const Case& the_case, const SiteSettings& site,
                                     const DrawingSettings& drawing);

/// The light does not wait for a disk; whoever records or keeps matches must know before it starts.
void warn_of_full_disks(const SessionOptions& options);

}  // namespace planlight
