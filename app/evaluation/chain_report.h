#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/evaluation/run_chain.h"
#include "app/prepare_case.h"
#include "app/report/html_page.h"

namespace planlight {

/// One figure of one preset over all its rooms, against what is to be reached.
struct ReportRow {
    std::string name, unit;
    Distribution found;
    std::string goal;     ///< in words; empty when there is none
    bool reached = true;  ///< false only when there is a goal and it was missed
};

/// All rooms of one preset together, refusals counted.
struct PresetSummary {
    std::string preset;
    std::size_t rooms = 0, matched_right = 0, refused = 0;
    std::vector<std::string> refusals;
    std::vector<ReportRow> rows;
    int dark_updates = 0, updates = 0;
    int lost_marker_lit = 0, lost_marker_updates = 0, too_few_lit = 0, too_few_updates = 0;
    double updates_per_s = 0;  ///< of the product's own work, at its median
    bool reached() const;
};

PresetSummary summarise(const std::vector<ChainFigures>& rooms, const std::string& preset);

/// report.json: the summary of every preset, and every room by itself. Returns the text that was written.
std::string write_report_json(const std::filesystem::path& file, const Preparation& prepared,
                              const std::vector<ChainFigures>& rooms);

/// report.html: one self-contained page with the figures and the pictures.
void write_report_html(const std::filesystem::path& file, const Preparation& prepared,
                       const std::vector<ChainFigures>& rooms, const std::vector<ReportPicture>& pictures);

}  // namespace planlight
