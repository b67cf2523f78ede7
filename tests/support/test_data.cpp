#include "tests/support/test_data.h"

#include <cstdlib>
#include <stdexcept>
#include <string>

namespace planlight::test {

namespace fs = std::filesystem;

std::optional<fs::path> example_patient() {
    const fs::path file = "/usr/share/doc/invesalius-examples/examples/Cranium.inv3";
    return fs::exists(file) ? std::optional(file) : std::nullopt;
}

std::optional<fs::path> third_party_data(const fs::path& relative) {
    const char* given = std::getenv("PLANLIGHT_TEST_DATA");
    const fs::path root = given ? fs::path(given) : fs::path(PLANLIGHT_SOURCE_DIR) / ".." / "shared" / "data";
    const fs::path path = root / relative;
    return fs::exists(path) ? std::optional(path) : std::nullopt;
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "planlight-test-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
}

}  // namespace planlight::test
