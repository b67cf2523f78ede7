#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/evaluation/run_chain.h"
#include "app/prepare_case.h"
#include "app/report/document.h"

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
    std::size_t said_yes = 0, said_ask = 0;  ///< verdicts of the match: used at once; only after a person has looked
    std::vector<std::string> refusals;
    std::vector<ReportRow> rows;
    int dark_updates = 0, updates = 0;
    int lost_marker_lit = 0, lost_marker_updates = 0, too_few_lit = 0, too_few_updates = 0;
    double updates_per_s = 0;  ///< of the product's own work, at its median
    /// Every goal that was missed, in words; empty when all were reached.
    std::vector<std::string> missed() const;
};

/// Of the rooms of `preset`; the others in `rooms` are left out. Without any, all counts are 0.
PresetSummary summarise(const std::vector<ChainFigures>& rooms, const std::string& preset);

/// A few lines and a table, for a terminal.
std::string summary_text(const PresetSummary& summary);

/// report.json: the summary of every preset, and every room by itself, with histograms of its errors so that reports
/// can be joined. Returns the text that was written.
std::string write_report_json(const std::filesystem::path& file, const Preparation& prepared,
                              const std::vector<ChainFigures>& rooms);

/// The reports of several runs with other seeds as one, written to `file`. Throws InputError for reports of two cases
/// or programs, for a room that is in two of them, and for a report that cannot be joined. Returns the summaries.
std::vector<PresetSummary> merge_reports(const std::vector<std::filesystem::path>& reports,
                                         const std::filesystem::path& file);

/// The report with the figures and the pictures.
Document chain_document(const Preparation& prepared, const std::vector<ChainFigures>& rooms,
                        const std::vector<ReportPicture>& pictures);

}  // namespace planlight
