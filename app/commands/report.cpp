#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/commands/pdf_option.h"
#include "app/console.h"
#include "app/report/operation_comparison.h"
#include "app/report/operation_pdf.h"
#include "app/report/operation_report.h"
#include "app/report/site_paper.h"
#include "planning_io/files/safe_write.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

struct ReportOptions {
    Path recording, out, pdf;
    Path case_folder;  ///< empty: where it was when it was recorded
    bool json = false;
};

/// Figures that a former report wrote.
bool is_of_a_report(const Path& figures) {
    const auto json = nlohmann::json::parse(std::ifstream(figures), nullptr, false);
    return json.is_object() && json.value("format", nlohmann::json()) == "planlight operation";
}

/// Neither the page nor its figures nor the PDF may stand where a recording does, or in each other's place.
void check_out(const Path& out, const Path& pdf, const Path& recording) {
    const auto refuse = [&](const Path& file, const std::string& problem) {
        throw InputError(file, problem, "Name pages: `planlight report RECORDING --out report.html --pdf report.pdf`.");
    };
    const auto same = [](const Path& a, const Path& b) {
        std::error_code not_there;
        const auto whole = [&](const Path& path) {
            return std::filesystem::weakly_canonical(std::filesystem::absolute(path, not_there), not_there);
        };
        return std::filesystem::equivalent(a, b, not_there) || whole(a) == whole(b);
    };
    const Path figures = Path(out).replace_extension(".json");
    for (const Path& file : {out, figures, pdf}) {
        if (file.empty()) continue;
        if (same(file, recording)) refuse(file, "is the recording itself, and a report would take its place");
        if (file.extension() == ".plrec") refuse(file, "is the name of a recording, not of a page");
    }
    if (std::filesystem::exists(figures) && !is_of_a_report(figures))
        refuse(figures, "is no report's, and the figures of this one would take its place");
    if (out.extension() == ".json") refuse(out, "is where the figures of the page go, not the page");
    if (!pdf.empty() && (same(pdf, out) || same(pdf, figures)))
        refuse(pdf, "is where the page or its figures go, not the PDF");
}

int run_report(const ReportOptions& options) {
    static_cast<void>(RecordingReader(options.recording));  // is one, before anything is asked of its page's place
    const Path out = options.out.empty() ? Path(options.recording).replace_extension(".html") : options.out;
    check_out(out, options.pdf, options.recording);
    check_can_write(out);
    check_can_write(Path(out).replace_extension(".json"));
    check_pdf(options.pdf);
    OperationFacts facts = facts_of_operation(options.recording);
    if (options.case_folder.empty())
        compare_moment(facts, options.recording);
    else
        compare_moment(facts, options.recording, read_case(options.case_folder));
    const std::string json = operation_json(facts);
    write_operation_report(facts, json, out);
    if (!options.pdf.empty()) write_safely(options.pdf, operation_pdf(facts, paper_of_site()), ReadableBy::owner);
    if (options.json)
        std::cout << json;
    else
        fmt::print("{}\n{}\n", verdict_of(facts).sentence, out.string());
    if (!facts.ended.empty()) warn(facts.ended);
    if (facts.damaged)
        throw DamagedFileError(options.recording, "is reported up to where it is damaged",
                               "Copy the file again from where it was written.");
    return 0;
}

}  // namespace

Run add_report(CLI::App& app) {
    const auto options = std::make_shared<ReportOptions>();
    ReportOptions& o = *options;
    auto* sub = add_command(app, "report", "A page on an operation: what was shown, when, and how far off it was",
                            "report case/recordings/2026-03-14T09-30-00Z.plrec --pdf report.pdf");
    sub->add_option("recording", o.recording, "Recording of a session")->required();
    sub->add_option("--out", o.out,
                    "Page to write (default: beside the recording); its figures stand beside it as .json");
    sub->add_option(
        "--case", o.case_folder,
        "Case folder, to measure plan and light of one moment (default: where it was when it was recorded)");
    pdf_option(sub, o.pdf);
    json_flag(sub, o.json);
    return [options] { return run_report(*options); };
}

}  // namespace planlight
