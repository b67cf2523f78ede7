#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "planning_io/files/safe_write.h"
#include "planning_io/surface/surface_file.h"
#include "planning_io/types/error.h"
#include "tests/support/test_data.h"

// What the tests of surface files share.
namespace planlight::test {

inline SurfaceSettings of_ct(const std::string& uid, const std::string& segment = {}) {
    SurfaceSettings settings;
    settings.said.frame_of_reference_uid = uid;
    settings.segment = segment;
    return settings;
}

inline SurfaceSettings in_lps() {
    SurfaceSettings settings;
    settings.said.space = Space::lps;
    return settings;
}

inline const Eigen::Vector3d& corner(const TriangleMesh& mesh, const std::array<std::int32_t, 3>& t, std::size_t c) {
    return mesh.vertices_in_ct[static_cast<std::size_t>(t[c])];
}

class SurfaceFileTest : public ::testing::Test {
protected:
    std::filesystem::path write(const std::string& name, const std::string& content) {
        write_safely(folder_.path() / name, content);
        return folder_.path() / name;
    }
    std::string refusal(const std::filesystem::path& file, const SurfaceSettings& settings = {}) {
        try {
            read_surface(file, settings);
        } catch (const Error& e) {
            return std::string(e.what()) + " " + e.remedy;
        }
        return {};
    }
    TemporaryFolder folder_;
};

}  // namespace planlight::test

/// The sentence holds these words.
#define EXPECT_SAYS(sentence, words) EXPECT_NE((sentence).find(words), std::string::npos) << (sentence)
