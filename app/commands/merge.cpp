#include <fmt/format.h>

#include <iostream>

#include "app/commands/command_line.h"
#include "app/commands/commands.h"
#include "app/evaluation/chain_report.h"
#include "planning_io/files/safe_write.h"

namespace planlight {
namespace {

struct MergeOptions {
    std::vector<Path> reports;
    Path out = "report.json";
    bool json = false;
};

int run_merge(const MergeOptions& options) {
    const auto summaries = merge_reports(options.reports, options.out);
    if (options.json)
        std::cout << read_whole(options.out);
    else
        for (const PresetSummary& summary : summaries) fmt::print("{}", summary_text(summary));
    return 0;
}

}  // namespace

Run add_merge(CLI::App& app) {
    const auto options = std::make_shared<MergeOptions>();
    MergeOptions& o = *options;
    auto* sub = add_command(app, "merge", "Reports of `demo` with other seeds -> one report of all their rooms",
                            "merge part-1/report.json part-11/report.json --out joined.json");
    sub->add_option("reports", o.reports, "report.json of each run")->required();
    sub->add_option("--out", o.out, "Joined report to write (.json)")->required();
    json_flag(sub, o.json);
    return [options] { return run_merge(*options); };
}

}  // namespace planlight
