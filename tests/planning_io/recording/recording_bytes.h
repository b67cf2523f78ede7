#pragma once

#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "planning_io/recording/recording_reader.h"
#include "planning_io/recording/recording_writer.h"

/// Recordings that tests write, read and spoil.
namespace planlight::test {

inline StereoFrame noisy_frame(std::uint64_t number, int width = 60, int height = 40) {
    std::mt19937 random(static_cast<unsigned>(number));
    StereoFrame frame{GrayImage(width, height), GrayImage(width, height), Instant(1000 * number), Instant(77), number};
    for (GrayImage* picture : {&frame.left, &frame.right})
        for (auto& p : picture->pixels) p = static_cast<std::uint8_t>(random());
    return frame;
}

inline std::string text(std::size_t i) {
    return "chunk " + std::to_string(i) + std::string(i % 300, 'x');
}

/// A recording of `count` events and the word that it is done.
inline void write_recording(const std::filesystem::path& file, std::size_t count) {
    RecordingWriter writer(std::make_unique<RecordingFile>(file));
    for (std::size_t i = 0; i < count; ++i) writer.add({chunk_types::kEvent, Instant(i), text(i)});
    writer.add({chunk_types::kDone, Instant(count), "{}"});
}

inline std::vector<RecordingChunk> read_all(RecordingReader& reader) {
    std::vector<RecordingChunk> chunks;
    while (auto chunk = reader.next()) chunks.push_back(std::move(*chunk));
    return chunks;
}

inline std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

inline void put_bytes(const std::filesystem::path& file, std::string_view bytes) {
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace planlight::test
