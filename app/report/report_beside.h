#pragma once

#include <filesystem>
#include <string>

namespace planlight {

/// A report of an operation that stands beside its recording.
struct ReportBeside {
    std::filesystem::path page, pdf;  ///< the page's figures stand beside it as .json
    std::string verdict;              ///< the page's first sentence
};

/// Page, figures and PDF under the recording's name (.html, .json, .pdf), readable by their owner only. Throws
/// InputError, DamagedFileError (no recording that can be reported), DiskError, DeviceError (no font for the PDF; the
/// page is there then).
ReportBeside write_report_beside(const std::filesystem::path& recording);

}  // namespace planlight
