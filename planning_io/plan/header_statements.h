#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "planning_io/plan/coordinate_space.h"

namespace planlight {

/// What people and programs write about the numbers of a file: comments, a title, "frame: RAS" for the field of a
/// column. A statement is a name, `=` or `:`, and a value, in any case of letters: "SPACE=LPS", "# Coordinate system:
/// RAS", "units = mm". Ordinary words say nothing.
///
/// Throws InputError for two statements that differ, and for a frame that is neither LPS nor RAS.
SpaceSaid space_said(std::string_view words, const std::filesystem::path& file);

/// mm per unit; empty when none is said. Throws InputError for a unit that is neither mm nor um, and, where no unit is
/// stated, for a line that speaks of "coordinates in cm". `how_to_say` is where the file would state it.
std::optional<double> unit_said(std::string_view words, const std::filesystem::path& file, std::string_view how_to_say);

/// Whether a column of this name states the frame or the unit of its row.
bool names_the_space(std::string_view name);
bool names_the_unit(std::string_view name);

}  // namespace planlight
