#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "tests/app/run_command.h"
#include "tests/support/test_data.h"

namespace planlight::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void change(const fs::path& file, const std::function<void(json&)>& how) {
    json content = json::parse(whole(file));
    how(content);
    std::ofstream(file) << content.dump();
}

/// The simulated room's light and its recording say the same; then what goes wrong. One test: a recording takes its
/// time.
TEST(ProjectorCommand, MeasuresARoomAndTheFolderThatItKept) {
    const TemporaryFolder folder;
    const fs::path& root = folder.path();
    const auto live = run_planlight(
        "projector --simulate paper --seed 3 --light delay-ms=20 --part latency --keep kept --serial X7K2 --out "
        "projector.json --json",
        root);
    ASSERT_EQ(live.exit_code, 0) << live.err;
    const json result = json::parse(live.out);
    EXPECT_NEAR(result["latency"]["median_ms"].get<double>(), 45, 0.5) << "25 ms that it promises, 20 that it does not";
    EXPECT_NEAR(result["latency"]["promised"]["delay_ms"].get<double>(), 25, 1e-6);
    EXPECT_GE(result["latency"]["light_delay_ms"].get<double>(), 45);
    EXPECT_NE(live.err.find("too early"), std::string::npos) << "and says so";
    EXPECT_EQ(result["projector"]["serial"], "X7K2");
    EXPECT_EQ(json::parse(whole(root / "projector.json")), result);
    const std::string page = whole(root / "projector.html");
    EXPECT_NE(page.find("delay to set"), std::string::npos);
    EXPECT_EQ(page.find("http"), std::string::npos) << "nothing comes from a network";

    const auto again = run_planlight("projector kept --json", root);
    ASSERT_EQ(again.exit_code, 0) << again.err;
    EXPECT_EQ(json::parse(again.out)["latency"], result["latency"]);
    const auto configured = run_planlight("projector kept --configured-ms 47 --json", root);
    EXPECT_EQ(json::parse(configured.out)["latency"]["promised"]["broken"], 0);

    expect_refused(run_planlight("projector kept --part cycle", root), 3, "no recording of light");
    expect_refused(run_planlight("projector", root), 2, "nothing to measure");
    expect_refused(run_planlight("projector --simulate paper --light gamam=2", root), 3, "gamam");
    const fs::path light = root / "kept/latency/light.json";
    const std::string good = whole(light);
    change(light, [](json& l) { l["frames"][7]["at_ns"] = 5; });
    expect_refused(run_planlight("projector kept", root), 3, "before the frame before it");
    std::ofstream(light) << good;
    change(light, [](json& l) { l["orders"][3]["colour"] = {0, 0, 256}; });
    expect_refused(run_planlight("projector kept", root), 3, "colour");
    std::ofstream(light) << good;
    change(light, [](json& l) { l["version"] = 2; });
    expect_refused(run_planlight("projector kept", root), 4, "version 2");
    std::ofstream(light) << good.substr(0, good.size() / 2);
    expect_refused(run_planlight("projector kept", root), 4, "light.json");
    std::ofstream(light) << good;
    change(light, [](json& l) {
        for (auto& frame : l["frames"]) frame["at_ns"] = frame["at_ns"].get<std::int64_t>() - 200'000'000;
    });
    const std::string before = whole(root / "projector.json");
    expect_refused(run_planlight("projector kept --out projector.json", root), 6, "before it was ordered");
    EXPECT_EQ(whole(root / "projector.json"), before) << "a refusal leaves the good file alone";
    std::ofstream(light) << good;
    fs::remove(root / "kept/latency/left/000011.png");
    expect_refused(run_planlight("projector kept", root), 3, "000011.png");
}

}  // namespace
}  // namespace planlight::test
