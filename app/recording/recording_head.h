#pragma once

#include "app/recording/session_recorder.h"

namespace planlight {

/// The HEAD chunk, and what stands in it. Throws InputError or DamagedFileError (`file`: for its words).
std::string text_of(const RecordingHead& head);
RecordingHead head_of(const std::string& text, const std::filesystem::path& file);

/// "none", "events", "all".
const char* word_of(RecordMode mode);
RecordMode record_mode_of(const std::string& word);

/// A new name for a recording in that folder: the date and the time of day, UTC.
std::filesystem::path new_recording_name(const std::filesystem::path& folder);

}  // namespace planlight
