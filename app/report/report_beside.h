#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace planlight {

/// A report of an operation that stands beside its recording.
struct ReportBeside {
    std::filesystem::path page, pdf;  ///< the page's figures stand beside it as .json
    std::string verdict;              ///< the page's first sentence
};

/// Page, figures and PDF under the recording's name (.html, .json, .pdf), readable by their owner only. Throws
/// InputError, DamagedFileError (no recording that can be reported), DiskError, DeviceError (no font for the PDF; the
/// page is there then). `go_on` (may be empty) is called again and again before anything is written: what it throws
/// ends it.
ReportBeside write_report_beside(const std::filesystem::path& recording, const std::function<void()>& go_on = {});

}  // namespace planlight
