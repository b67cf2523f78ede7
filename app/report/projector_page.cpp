#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "app/report/html_page.h"
#include "app/report/projector_report.h"
#include "app/report/svg_chart.h"
#include "planning_io/files/safe_write.h"
#include "registration/projector_measurement/fit_response.h"

namespace planlight {
namespace {

constexpr const char *kSeen = "#0b8a4c", *kFit = "#1f6feb", *kWarn = "#b45f06";

std::string figure(const std::string& svg, const std::string& title, const std::string& caption) {
    return fmt::format("<figure>{}<figcaption><b>{}</b>{}</figcaption></figure>", svg, xml_escaped(title),
                       xml_escaped(caption));
}

std::string curve_chart(const ResponseResult& r, double to_grey, double to_light) {
    SvgChart chart({0, to_grey, "grey of the picture"}, {0, to_light, "light, white = 1"});
    SvgChart::Points seen, fitted;
    std::vector<double> sigma;
    for (const ResponsePoint& p : r.curve)
        if (p.grey <= to_grey && p.light <= 1.02 * to_light)
            seen.emplace_back(p.grey, p.light), sigma.push_back(2 * p.sigma);
    for (int i = 0; i <= 255; ++i)
        if (const double light = fitted_light(r, i); i <= to_grey && light <= 1.001 * to_light)
            fitted.emplace_back(i, light);
    chart.line(fitted, kFit);
    chart.dots(seen, kSeen, sigma);
    return chart.text();
}

std::string section(const ResponseResult& r) {
    double dark_light = 0.01;
    for (const ResponsePoint& p : r.curve)
        if (p.grey <= 48) dark_light = std::max(dark_light, 1.1 * p.light);
    std::string html = fmt::format(
        "<h2>Response</h2><p>Gamma {:.3f} &plusmn; {:.3f}; black up to grey {:.1f} &plusmn; {:.1f}, white from grey "
        "{:.1f} &plusmn; {:.1f}. The curve departs from that by {:.2f} % of white at most. ",
        r.gamma, r.gamma_sigma, r.dark_end, r.dark_end_sigma, r.bright_end, r.bright_end_sigma,
        100 * r.worst_departure);
    html +=
        r.black_level_is_a_bound
            ? fmt::format(
                  "Black gives {:.2f} % of white's light, the room's lamps included; put the lid before the lens to "
                  "know the projector's own share.",
                  100 * r.black_level)
            : fmt::format("Black gives {:.3f} &plusmn; {:.3f} % of white's light: a contrast of {:.0f} to 1.",
                          100 * r.black_level, 100 * r.black_level_sigma, r.black_level > 0 ? 1 / r.black_level : 0);
    html += "</p>";
    if (r.colours)
        html += fmt::format(
            "<p>Alone, as the cameras see them: red {:.1f} %, green {:.1f} %, blue {:.1f} % of white; together {:.1f} "
            "%.</p>",
            100 * (*r.colours)[0], 100 * (*r.colours)[1], 100 * (*r.colours)[2],
            100 * ((*r.colours)[0] + (*r.colours)[1] + (*r.colours)[2]));
    html += fmt::format(
        "<p>{}</p><div class=\"grid\">{}{}</div><p class=\"muted\">{} tiles of both pictures; black is {:.0f}, white "
        "{:.0f} grey there; "
        "{} tiles left out because white saturates.</p>",
        xml_escaped(meaning_of(r)),
        figure(curve_chart(r, 256, 1), "Measured curve",
               "Points: measured, bars: two standard deviations. Line: fitted."),
        figure(curve_chart(r, 48, dark_light), "Its dark end",
               "Where points stay at 0, the projector crushes the darks."),
        r.tiles, r.black_grey, r.white_grey, r.saturated_tiles);
    return html;
}

std::string colour_of(const std::string& name) {
    if (name == "red") return "#c0392b";
    if (name == "green") return kSeen;
    if (name == "blue") return kFit;
    return name == "black" ? "#1b232c" : "#8a94a0";
}

std::string section(const CycleResult& r) {
    std::string html = fmt::format(
        "<h2>Colour cycle</h2><p>{}</p><table><tr><th>Picture</th><th>Variation</th><th>At most (95 %)</th><th></th>"
        "<th>Seen at</th><th>Cycles that look so</th></tr>",
        xml_escaped(meaning_of(r)));
    for (const CycleRun& run : r.runs) {
        std::string cycles;
        for (const double hz : run.cycles_hz) cycles += fmt::format("{}{:g} Hz", cycles.empty() ? "" : " or ", hz);
        html += fmt::format(
            "<tr><td>{}{}</td><td>{:.2f} &plusmn; {:.2f} %</td><td>{:.2f} %</td><td "
            "class=\"{}\">{}</td><td>{}</td><td>{}</td></tr>",
            run.name, run.name == "black" ? " (the room)" : "", 100 * run.variation, 100 * run.variation_sigma,
            100 * run.at_most, run.varies ? "no" : "yes", run.varies ? "varies" : "steady",
            run.seen_hz ? fmt::format("{:.1f} Hz", *run.seen_hz) : "", cycles);
    }
    html += "</table><div class=\"grid\">";
    for (const CycleRun& run : r.runs) {
        double most = 0.01;
        SvgChart::Points trace;
        for (std::size_t i = 0; i < run.trace.size(); ++i) {
            trace.emplace_back(static_cast<double>(i), 100 * static_cast<double>(run.trace[i]));
            most = std::max(most, 1.1 * std::abs(static_cast<double>(run.trace[i])));
        }
        SvgChart chart({0, std::max(1.0, static_cast<double>(run.trace.size())), "frame"},
                       {-100 * most, 100 * most, "% of its light"}, 560, 220);
        chart.line(trace, colour_of(run.name));
        html += figure(chart.text(), run.name == "black" ? "black: the room alone" : run.name, "");
    }
    return html + fmt::format("</div><p class=\"muted\">{:.2f} frames a second, exposed for {:.2f} ms.</p>",
                              r.frames_hz, 1e3 * r.exposure_s);
}

std::string histogram(const LatencyResult& r) {
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
    SvgChart chart({1e3 * low, 1e3 * high, "from order to light, ms", 8}, {0, 1.35 * std::max(1.0, most), "changes"},
                   1140, 340);
    for (int b = 0; b < kBars; ++b) {
        const auto i = static_cast<std::size_t>(b);
        chart.bar(1e3 * (low + b * width), 1e3 * (low + (b + 1) * width), all[i], "#a9d8bf");
        chart.bar(1e3 * (low + b * width), 1e3 * (low + (b + 1) * width), exact[i], kSeen);
    }
    chart.mark(1e3 * r.median_s, fmt::format("median {:.1f} ms", 1e3 * r.median_s), "#1b232c", 0);
    if (r.promise)
        chart.mark(1e3 * r.promise->delay_s, fmt::format("promised {:.1f} ms", 1e3 * r.promise->delay_s), kWarn, 1);
    chart.mark(1e3 * r.light_delay_s, fmt::format("delay to set {:.0f} ms", 1e3 * r.light_delay_s), kFit, 2);
    return chart.text();
}

std::string section(const LatencyResult& r) {
    return fmt::format(
        "<h2>Latency</h2><p>{}</p>{}<p class=\"muted\">Agreement with the code {:.3f}, at the next best delay {:.3f}. "
        "{} changes, {} never "
        "light, {} a refresh late; {} frames lost, {} doubled.</p>",
        xml_escaped(meaning_of(r)),
        figure(histogram(r), "Delays of the flashes",
               "Dark: changes within an exposure. Pale: changes between two exposures, spread over the time between "
               "them."),
        r.code_agreement, r.runner_up_agreement, r.changes, r.unseen, r.late, r.frames.lost, r.frames.doubled);
}

template <class Result>
std::string section_or_refusal(const std::optional<Result>& result, const char* what) {
    if (!result) return {};
    if (!result->refusal) return section(*result);
    return fmt::format("<h2>{}</h2><p class=\"no\">Not measured: {}. {}</p>", what,
                       xml_escaped(result->refusal->reason), xml_escaped(result->refusal->remedy));
}

}  // namespace

void write_projector_html(const ProjectorReport& report, const std::filesystem::path& file) {
    const auto findings = findings_of(report);
    ReportFacts facts{{"Measured", report.made_on}, {"From", report.source}};
    if (report.width > 0) facts.emplace_back("Picture", fmt::format("{} x {}", report.width, report.height));
    facts.emplace_back("Serial", report.serial.empty() ? "not given" : report.serial);
    facts.emplace_back("Monitor", report.monitor);
    std::string body;
    body += findings.empty()
                ? "<div class=\"verdict yes\">&#10003; Nothing that a scan or the light would suffer from.</div>"
                : fmt::format("<div class=\"verdict no\">&#9888; {} thing{} to set right.</div>", findings.size(),
                              findings.size() == 1 ? "" : "s");
    for (LightFinding finding : findings) {
        finding.what[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(finding.what[0])));
        body += fmt::format("<p><span class=\"no\">{}.</span> {}</p>", xml_escaped(finding.what),
                            xml_escaped(finding.remedy));
    }
    body += section_or_refusal(report.latency, "Latency") + section_or_refusal(report.response, "Response") +
            section_or_refusal(report.cycle, "Colour cycle");
    write_safely(file, html_page("Projector", body, facts));
}

}  // namespace planlight
