#include <fmt/format.h>

#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>

#include "app/commands/archive_options.h"
#include "app/commands/commands.h"
#include "app/console.h"
#include "app/json_text.h"
#include "planning_io/case/case_names.h"
#include "planning_io/types/error.h"

namespace planlight {
namespace {

struct FetchOptions {
    ArchiveOptions archive;
    SeriesQuery query;
    Path out;
    bool check = false, json = false;
};

nlohmann::ordered_json json_of(const FoundSeries& series) {
    return {{"patient_id", series.patient_id},   {"patient_name", series.patient_name},
            {"study_date", series.study_date},   {"study", series.study_description},
            {"study_uid", series.study_uid},     {"series_uid", series.series_uid},
            {"modality", series.modality},       {"number", series.number},
            {"description", series.description}, {"images", series.images}};
}

std::string line_of(const FoundSeries& series) {
    return without_control_characters(
        fmt::format("{}  {}  {}  series {} {}  {}{}  {}", series.study_date, series.patient_id, series.patient_name,
                    series.number, series.modality, series.description,
                    series.images.empty() ? "" : fmt::format("  ({} images)", series.images), series.series_uid));
}

void print_found(const std::vector<FoundSeries>& found, bool json) {
    if (json) {
        nlohmann::ordered_json all = nlohmann::ordered_json::array();
        for (const FoundSeries& series : found) all.push_back(json_of(series));
        std::cout << json_text(all) << '\n';
        return;
    }
    for (const FoundSeries& series : found) fmt::print("{}\n", line_of(series));
}

/// The one series that is meant.
const FoundSeries& only_one(const std::vector<FoundSeries>& found) {
    if (found.size() == 1) return found.front();
    std::string list;
    constexpr std::size_t kMost = 12;
    for (std::size_t i = 0; i < std::min(found.size(), kMost); ++i) list += "\n  " + line_of(found[i]);
    throw InputError({}, fmt::format("{} series are found, and one is fetched at a time:{}", found.size(), list),
                     "Give --series with the UID of one of them.");
}

/// An archive takes a date with hyphens in it for a range, and finds nothing.
void check_date(const std::string& date) {
    if (date.empty()) return;
    const auto is_day = [](const std::string& text) {
        if (text.size() != 8 || text.find_first_not_of("0123456789") != std::string::npos) return false;
        const auto number = [&](std::size_t from, std::size_t count) { return std::stoi(text.substr(from, count)); };
        return std::chrono::year_month_day(std::chrono::year(number(0, 4)),
                                           std::chrono::month(static_cast<unsigned>(number(4, 2))),
                                           std::chrono::day(static_cast<unsigned>(number(6, 2))))
            .ok();
    };
    const std::size_t hyphen = date.find('-');
    const std::string from = date.substr(0, hyphen), to = hyphen == std::string::npos ? from : date.substr(hyphen + 1);
    if ((is_day(from) && (to.empty() || is_day(to))) || (from.empty() && is_day(to))) return;
    throw Error(ExitCode::usage, fmt::format("--date {} is no day and no range of days", date),
                "Write the day as YYYYMMDD, or a range as YYYYMMDD-YYYYMMDD.");
}

int run_fetch(const FetchOptions& options) {
    const DicomPeer archive = archive_of(options.archive);
    if (options.check) {
        ask_whether_it_answers(archive);
        if (options.json)
            std::cout << json_text(nlohmann::json{{"archive", archive.name()}, {"answers", true}}) << '\n';
        else
            fmt::print("{} answers.\n", archive.name());
        return 0;
    }
    const SeriesQuery& q = options.query;
    check_date(q.study_date);
    if ((q.patient_id + q.patient_name + q.accession_number + q.study_date + q.study_uid + q.series_uid).empty())
        throw Error(ExitCode::usage, "nothing says what is looked for",
                    "Give --patient-id, --patient-name, --accession, --date, --study or --series.");
    const auto found = find_series(archive, options.query);
    if (found.empty())
        throw InputError({}, fmt::format("the archive {} finds no such series", archive.name()),
                         "Leave out what you are not sure of, or write * in its place.");
    if (options.out.empty()) {
        print_found(found, options.json);
        return 0;
    }
    const FoundSeries& series = only_one(found);
    std::size_t images = 0;
    {
        ProgressBar bar;
        images = fetch_series(archive, series, options.out, [&](std::size_t done, std::size_t of) {
            bar.show("fetch", static_cast<double>(done) / static_cast<double>(of));
        });
    }
    if (options.json) {
        auto told = json_of(series);
        told["folder"] = options.out.string();
        told["files"] = images;
        std::cout << json_text(told) << '\n';
    } else {
        fmt::print("{}\n{} images in {}, as `planlight prepare` reads them. They name the patient.\n", line_of(series),
                   images, options.out.string());
    }
    return 0;
}

}  // namespace

Run add_fetch(CLI::App& app) {
    const auto options = std::make_shared<FetchOptions>();
    FetchOptions& o = *options;
    auto* sub = add_command(app, "fetch", "Find series in a DICOM archive (PACS), and fetch one for `prepare`",
                            "fetch --patient-id 4711 --modality CT --out ct-series");
    sub->add_option("--patient-id", o.query.patient_id, "The patient's ID (* and ? stand for what is not known)");
    sub->add_option("--patient-name", o.query.patient_name, "The patient's name, as DICOM has it: Family^Given");
    sub->add_option("--accession", o.query.accession_number, "Accession number");
    sub->add_option("--date", o.query.study_date, "Day of the study, YYYYMMDD, or a range of them with a hyphen");
    sub->add_option("--study", o.query.study_uid, "UID of the study");
    sub->add_option("--series", o.query.series_uid, "UID of the series");
    sub->add_option("--modality", o.query.modality, "CT, MR, RTSTRUCT, SEG");
    auto* out = sub->add_option("--out", o.out, "New folder for its files (default: what is found is listed)");
    sub->add_flag("--check", o.check, "Only ask whether the archive answers (C-ECHO)")->excludes(out);
    archive_options(sub, o.archive, true);
    json_flag(sub, o.json);
    return [options] { return run_fetch(*options); };
}

}  // namespace planlight
