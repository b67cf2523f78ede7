#pragma once

#include <Eigen/Core>
#include <filesystem>

#include "app/export/export_study.h"
#include "tests/support/test_data.h"

namespace planlight::test {

/// The phantom's series as files, its case with an item of every kind, and a match of an invented scan.
struct ExportedPhantom {
    TemporaryFolder folder;
    std::filesystem::path series;
    Case prepared;
    ExportedOperation operation;
};

/// The one of this process, made when it is first asked for.
ExportedPhantom& exported_phantom();

/// Where the plan of it begins: on the front of the phantom's head; ct, mm.
Eigen::Vector3d place_on_phantom();

}  // namespace planlight::test
