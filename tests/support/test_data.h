#pragma once

#include <filesystem>
#include <optional>

namespace planlight::test {

/// The example patient of Debian's package invesalius-examples; empty when the package is not installed.
std::optional<std::filesystem::path> example_patient();

/// A path in the folder of third-party data beside the checkout (../shared/data, or $PLANLIGHT_TEST_DATA); empty when
/// it is not there. A test on such data skips, saying so.
std::optional<std::filesystem::path> third_party_data(const std::filesystem::path& relative);

/// A fresh empty folder that is removed with the object.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

}  // namespace planlight::test
