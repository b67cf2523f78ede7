#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "app/report/projector_report.h"
#include "registration/projector_measurement/fit_response.h"

namespace planlight {
namespace {

constexpr Rgb kSeen{0x0b, 0x8a, 0x4c}, kFit{0x1f, 0x6f, 0xeb}, kWarn{0xb4, 0x5f, 0x06};

Chart curve_chart(const ResponseResult& r, double to_grey, double to_light) {
    Chart chart({0, to_grey, "grey of the picture"}, {0, to_light, "light, white = 1"});
    Chart::Points seen, fitted;
    std::vector<double> sigma;
    for (const ResponsePoint& p : r.curve)
        if (p.grey <= to_grey && p.light <= 1.02 * to_light)
            seen.emplace_back(p.grey, p.light), sigma.push_back(2 * p.sigma);
    for (int i = 0; i <= 255; ++i)
        if (const double light = fitted_light(r, i); i <= to_grey && light <= 1.001 * to_light)
            fitted.emplace_back(i, light);
    chart.line(fitted, kFit);
    chart.dots(seen, kSeen, sigma);
    return chart;
}

std::string fit_in_words(const ResponseResult& r) {
    const std::string fit = fmt::format(
        "Gamma {:.3f} ± {:.3f}; black up to grey {:.1f} ± {:.1f}, white from grey {:.1f} ± {:.1f}. The curve departs "
        "from that by {:.2f} % of white at most. ",
        r.gamma, r.gamma_sigma, r.dark_end, r.dark_end_sigma, r.bright_end, r.bright_end_sigma,
        100 * r.worst_departure);
    if (r.black_level_is_a_bound)
        return fit +
               fmt::format(
                   "Black gives {:.2f} % of white's light, the room's lamps included; put the lid before the lens "
                   "to know the projector's own share.",
                   100 * r.black_level);
    return fit + fmt::format("Black gives {:.3f} ± {:.3f} % of white's light: a contrast of {:.0f} to 1.",
                             100 * r.black_level, 100 * r.black_level_sigma, r.black_level > 0 ? 1 / r.black_level : 0);
}

void add_section(const ResponseResult& r, std::vector<DocumentBlock>& blocks) {
    double dark_light = 0.01;
    for (const ResponsePoint& p : r.curve)
        if (p.grey <= 48) dark_light = std::max(dark_light, 1.1 * p.light);
    blocks.push_back(DocumentText{fit_in_words(r)});
    if (r.colours) {
        const auto& [red, green, blue] = *r.colours;
        blocks.push_back(DocumentText{fmt::format(
            "Alone, as the cameras see them: red {:.1f} %, green {:.1f} %, blue {:.1f} % of white; together {:.1f} %.",
            100 * red, 100 * green, 100 * blue, 100 * (red + green + blue))});
    }
    blocks.push_back(DocumentText{meaning_of(r)});
    blocks.push_back(DocumentFigures{
        {{"Measured curve", "Points: measured, bars: two standard deviations. Line: fitted.", curve_chart(r, 256, 1)},
         {"Its dark end", "Where points stay at 0, the projector crushes the darks.",
          curve_chart(r, 48, dark_light)}}});
    blocks.push_back(DocumentText{
        fmt::format(
            "{} tiles of both pictures; black is {:.0f}, white {:.0f} grey there; {} tiles left out because white "
            "saturates.",
            r.tiles, r.black_grey, r.white_grey, r.saturated_tiles),
        Tone::quiet});
}

Rgb colour_of(const std::string& name) {
    if (name == "red") return Rgb{0xc0, 0x39, 0x2b};
    if (name == "green") return kSeen;
    if (name == "blue") return kFit;
    return name == "black" ? Rgb{0x1b, 0x23, 0x2c} : Rgb{0x8a, 0x94, 0xa0};
}

DocumentTable runs_of(const CycleResult& r) {
    DocumentTable table{
        {{"Picture"}, {"Variation"}, {"At most (95 %)"}, {"Verdict"}, {"Seen at"}, {"Cycles that look so"}}, {}};
    for (const CycleRun& run : r.runs) {
        std::string cycles;
        for (const double hz : run.cycles_hz) cycles += fmt::format("{}{:g} Hz", cycles.empty() ? "" : " or ", hz);
        table.rows.push_back({{run.name + (run.name == "black" ? " (the room)" : "")},
                              {fmt::format("{:.2f} ± {:.2f} %", 100 * run.variation, 100 * run.variation_sigma)},
                              {fmt::format("{:.2f} %", 100 * run.at_most)},
                              {run.varies ? "✗ varies" : "✓ steady", run.varies ? Tone::stop : Tone::good},
                              {run.seen_hz ? fmt::format("{:.1f} Hz", *run.seen_hz) : ""},
                              {cycles}});
    }
    return table;
}

Chart trace_of(const CycleRun& run) {
    double most = 0.01;
    Chart::Points trace;
    for (std::size_t i = 0; i < run.trace.size(); ++i) {
        trace.emplace_back(static_cast<double>(i), 100 * static_cast<double>(run.trace[i]));
        most = std::max(most, 1.1 * std::abs(static_cast<double>(run.trace[i])));
    }
    Chart chart({0, std::max(1.0, static_cast<double>(run.trace.size())), "frame"},
                {-100 * most, 100 * most, "% of its light"}, 560, 220);
    chart.line(trace, colour_of(run.name));
    return chart;
}

void add_section(const CycleResult& r, std::vector<DocumentBlock>& blocks) {
    blocks.push_back(DocumentText{meaning_of(r)});
    blocks.push_back(runs_of(r));
    DocumentFigures traces;
    for (const CycleRun& run : r.runs)
        traces.figures.push_back({run.name == "black" ? "black: the room alone" : run.name, "", trace_of(run)});
    blocks.push_back(traces);
    blocks.push_back(DocumentText{
        fmt::format("{:.2f} frames a second, exposed for {:.2f} ms.", r.frames_hz, 1e3 * r.exposure_s), Tone::quiet});
}

Chart histogram(const LatencyResult& r) {
    double low = r.light_delay_s, high = r.light_delay_s;
    for (const LightDelay& d : r.delays) low = std::min(low, d.at_least_s), high = std::max(high, d.at_most_s);
    if (r.promise) low = std::min(low, r.promise->delay_s), high = std::max(high, r.promise->delay_s);
    constexpr double kAround_s = 0.025;  // a change between slow frames is known to much less than the rest
    low = std::max(low, std::min(r.median_s, r.promise ? r.promise->delay_s : r.median_s) - kAround_s);
    high = std::min(high, std::max(r.light_delay_s, r.promise ? r.promise->delay_s : 0) + kAround_s);
    const double room = 0.06 * (high - low) + 0.001;
    low -= room, high += room;
    constexpr int kBars = 48;
    std::vector<double> exact(kBars, 0), all(kBars, 0);
    const double width = (high - low) / kBars;
    for (const LightDelay& d : r.delays)
        for (int b = 0; b < kBars; ++b) {
            const double from = low + b * width, to = from + width;
            const auto i = static_cast<std::size_t>(b);
            if (d.exact) {
                const double here = d.at_least_s >= from && d.at_least_s < to ? 1 : 0;
                exact[i] += here, all[i] += here;
            } else {
                all[i] += std::max(0.0, std::min(to, d.at_most_s) - std::max(from, d.at_least_s)) /
                          std::max(1e-9, d.at_most_s - d.at_least_s);
            }
        }
    const double most = *std::max_element(all.begin(), all.end());
    Chart chart({1e3 * low, 1e3 * high, "from order to light, ms", 8}, {0, 1.35 * std::max(1.0, most), "changes"}, 1140,
                340);
    for (int b = 0; b < kBars; ++b) {
        const auto i = static_cast<std::size_t>(b);
        chart.bar(1e3 * (low + b * width), 1e3 * (low + (b + 1) * width), all[i], Rgb{0xa9, 0xd8, 0xbf});
        chart.bar(1e3 * (low + b * width), 1e3 * (low + (b + 1) * width), exact[i], kSeen);
    }
    chart.mark(1e3 * r.median_s, fmt::format("median {:.1f} ms", 1e3 * r.median_s), Rgb{0x1b, 0x23, 0x2c}, 0);
    if (r.promise)
        chart.mark(1e3 * r.promise->delay_s, fmt::format("promised {:.1f} ms", 1e3 * r.promise->delay_s), kWarn, 1);
    chart.mark(1e3 * r.light_delay_s, fmt::format("delay to set {:.0f} ms", 1e3 * r.light_delay_s), kFit, 2);
    return chart;
}

void add_section(const LatencyResult& r, std::vector<DocumentBlock>& blocks) {
    blocks.push_back(DocumentText{meaning_of(r)});
    blocks.push_back(DocumentFigures{{{"Delays of the flashes",
                                       "Dark: changes within an exposure. Pale: changes between two exposures, spread "
                                       "over the time between them.",
                                       histogram(r)}}});
    blocks.push_back(DocumentText{
        fmt::format("Agreement with the code {:.3f}, at the next best delay {:.3f}. {} changes, {} never light, {} a "
                    "refresh late; {} frames lost, {} doubled.",
                    r.code_agreement, r.runner_up_agreement, r.changes, r.unseen, r.late, r.frames.lost,
                    r.frames.doubled),
        Tone::quiet});
}

template <class Result>
void add_part(const std::optional<Result>& result, const char* what, std::vector<DocumentBlock>& blocks) {
    if (!result) return;
    blocks.push_back(DocumentHeading{what});
    if (result->refusal)
        blocks.push_back(DocumentText{
            fmt::format("Not measured: {}. {}", result->refusal->reason, result->refusal->remedy), Tone::stop});
    else
        add_section(*result, blocks);
}

PageVerdict verdict_of(std::vector<LightFinding> findings) {
    if (findings.empty()) return {PageVerdict::Kind::good, "Nothing that a scan or the light would suffer from.", {}};
    PageVerdict verdict{PageVerdict::Kind::look,
                        fmt::format("{} thing{} to set right.", findings.size(), findings.size() == 1 ? "" : "s"),
                        {}};
    for (LightFinding& finding : findings) {
        finding.what[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(finding.what[0])));
        verdict.reasons.push_back(finding.what + ". " + finding.remedy);
    }
    return verdict;
}

}  // namespace

Document projector_document(const ProjectorReport& report) {
    Document document{"Projector"};
    document.verdict = verdict_of(findings_of(report));
    ReportFacts facts{{"Measured", report.made_on}, {"From", report.source}};
    if (report.width > 0) facts.emplace_back("Picture", fmt::format("{} x {}", report.width, report.height));
    facts.emplace_back("Serial", report.serial.empty() ? "not given" : report.serial);
    facts.emplace_back("Monitor", report.monitor);
    document.facts = with_program(facts);
    add_part(report.latency, "Latency", document.blocks);
    add_part(report.response, "Response", document.blocks);
    add_part(report.cycle, "Colour cycle", document.blocks);
    document.signed_by = {"Read and accepted by"};
    document.foot = foot_of_program();
    return document;
}

}  // namespace planlight
