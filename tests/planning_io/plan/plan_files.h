#pragma once

#include <gtest/gtest.h>

#include <string>

#include "planning_io/files/safe_write.h"
#include "planning_io/plan/plan_import.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

#define EXPECT_SAYS(sentence, words) EXPECT_NE((sentence).find(words), std::string::npos) << (sentence)

namespace planlight::test {

namespace fs = std::filesystem;

inline const PlanImportSettings kLps{Space::lps, {}}, kRas{Space::ras, {}};

/// Files that are imported as plans.
class PlanFiles : public ::testing::Test {
protected:
    fs::path write(const std::string& name, const std::string& content) {
        write_safely(folder_.path() / name, content);
        return folder_.path() / name;
    }
    /// The sentence with which a file is refused; empty when it is not.
    std::string refusal(const std::string& name, const std::string& content, const PlanImportSettings& settings = {}) {
        try {
            import_plan(write(name, content), settings);
        } catch (const Error& e) {
            return std::string(e.what()) + " " + e.remedy;
        }
        return {};
    }
    TemporaryFolder folder_;
};

inline std::string fcsv(const std::string& version, const std::string& system, const std::string& rows) {
    return "# Markups fiducial file version = " + version + "\n" +
           (system.empty() ? "" : "# CoordinateSystem = " + system + "\n") +
           "# columns = id,x,y,z,ow,ox,oy,oz,vis,sel,lock,label,desc,associatedNodeID\n" + rows;
}

}  // namespace planlight::test
