// A recording gives back what was handed over up to the last whole chunk, whatever happens to its file.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <fstream>
#include <random>
#include <thread>

#include "planning_io/recording/file_window.h"
#include "planning_io/recording/packed_pictures.h"
#include "planning_io/recording/recording_reader.h"
#include "planning_io/recording/recording_writer.h"
#include "planning_io/types/error.h"
#include "tests/planning_io/recording/kill_writer.h"
#include "tests/planning_io/recording/recording_bytes.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using namespace test;

TEST(Recording, GivesBackWhatWasHandedOverInItsOrder) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "new" / "session.plrec";
    write_recording(file, 500);
    RecordingReader reader(file);
    const auto chunks = read_all(reader);
    ASSERT_EQ(chunks.size(), 501u);
    for (std::size_t i = 0; i < 500; ++i) {
        EXPECT_EQ(chunks[i].payload, text(i));
        EXPECT_EQ(chunks[i].at, Instant(i));
    }
    EXPECT_EQ(reader.end(), RecordingEnd::whole);
    EXPECT_EQ(reader.sentence(), "");
}

TEST(Recording, IsReadableByItsOwnerOnlyAndNeverWrittenOver) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "new" / "session.plrec";
    write_recording(file, 1);
    struct stat status {};
    ASSERT_EQ(::stat(file.c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0600u);
    ASSERT_EQ(::stat(file.parent_path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, 0700u);
    EXPECT_THROW(RecordingFile{file}, DiskError);
}

TEST(Recording, WhoseFolderCannotBeMadeIsRefusedAsTheDisksDoing) {
    const TemporaryFolder folder;
    // A name that no file system takes stands for a folder that nobody may look into: root may.
    EXPECT_THROW(RecordingFile{folder.path() / std::string(300, 'x') / "session.plrec"}, DiskError);
    put_bytes(folder.path() / "file", "x");
    EXPECT_THROW(RecordingFile{folder.path() / "file" / "session.plrec"}, DiskError);
    try {
        RecordingFile{folder.path() / "file"};
        ADD_FAILURE();
    } catch (const DiskError& fault) {
        EXPECT_EQ(fault.remedy.find("Make room"), std::string::npos) << "there is room: " << fault.remedy;
    }
}

TEST(Recording, WhoJumpsFromHeaderToHeaderReadsLittleAndWhoGoesOnReadsAllOnce) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "pictures";
    std::string bytes(std::size_t{10'000'000}, '\0');
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i % 251);
    put_bytes(file, bytes);
    FileWindow jumps(file), goes_on(file);
    for (std::size_t at = 0; at < bytes.size(); at += 250'000)
        EXPECT_EQ(jumps.bytes(at, 32), std::string_view(bytes).substr(at, 32));
    EXPECT_LE(jumps.bytes_read(), 40u * 8192) << "of 40 pictures";
    for (std::size_t at = 0; at < bytes.size(); at += 1000)
        EXPECT_EQ(goes_on.bytes(at, 1000), std::string_view(bytes).substr(at, 1000));
    EXPECT_LT(goes_on.bytes_read(), bytes.size() * 11 / 10);
}

TEST(Recording, KeepsEveryPixelAndTimeOfAFrame) {
    for (const auto& frame : {noisy_frame(3), noisy_frame(4, 1, 1), StereoFrame{}}) {
        const StereoFrame again = unpack_frame(pack_frame(frame), "x");
        EXPECT_EQ(again.left.pixels, frame.left.pixels);
        EXPECT_EQ(again.right.pixels, frame.right.pixels);
        EXPECT_EQ(again.left.width, frame.left.width);
        EXPECT_EQ(again.at, frame.at);
        EXPECT_EQ(again.exposure, frame.exposure);
        EXPECT_EQ(again.number, frame.number);
        EXPECT_EQ(hash_of(again), hash_of(frame));
    }
    RgbImage light(31, 17, {0, 0, 0});
    for (int x = 0; x < 31; ++x) light.at(x, 5) = {static_cast<std::uint8_t>(x), 255, 7};
    EXPECT_EQ(unpack_picture(pack_picture(light), "x").pixels, light.pixels);
    EXPECT_NE(hash_of(light), hash_of(RgbImage(31, 17)));
}

TEST(Recording, CutAnywhereItGivesAllWholeChunksBeforeTheCut) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "whole.plrec", cut = folder.path() / "cut.plrec";
    write_recording(file, 12);
    const std::string bytes = bytes_of(file);
    std::vector<std::size_t> ends{kRecordingHeaderBytes};  // of the chunks
    for (std::size_t i = 0; i < 12; ++i) ends.push_back(ends.back() + kChunkHeaderBytes + text(i).size());
    for (std::size_t length = kRecordingHeaderBytes; length < bytes.size(); ++length) {
        put_bytes(cut, std::string_view(bytes).substr(0, length));
        RecordingReader reader(cut);
        const auto whole =
            static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), length) - ends.begin() - 1);
        EXPECT_EQ(read_all(reader).size(), whole) << "cut at " << length;
        EXPECT_EQ(reader.end(), RecordingEnd::cut) << "cut at " << length;
    }
    for (std::size_t length = 0; length < kRecordingHeaderBytes; ++length) {
        put_bytes(cut, std::string_view(bytes).substr(0, length));
        EXPECT_THROW(RecordingReader{cut}, Error) << "cut at " << length;
    }
}

TEST(Recording, EveryFlippedBitIsNoticedAndNothingBehindItIsGiven) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "whole.plrec", bad = folder.path() / "bad.plrec";
    write_recording(file, 5);
    const std::string bytes = bytes_of(file);
    RecordingReader sound(file);
    const auto chunks = read_all(sound);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        std::string spoilt = bytes;
        spoilt[i] = static_cast<char>(spoilt[i] ^ (1 << (i % 8)));
        put_bytes(bad, spoilt);
        if (i < kRecordingHeaderBytes) {
            EXPECT_THROW(RecordingReader{bad}, Error) << "byte " << i;
            continue;
        }
        RecordingReader reader(bad);
        const auto read = read_all(reader);
        ASSERT_LT(read.size(), chunks.size()) << "byte " << i;
        for (std::size_t k = 0; k < read.size(); ++k) EXPECT_EQ(read[k].payload, chunks[k].payload);
        EXPECT_NE(reader.end(), RecordingEnd::whole) << "byte " << i;
        // In the last chunk a changed byte cannot be told from a cut.
        if (read.size() + 1 < chunks.size()) {
            EXPECT_EQ(reader.end(), RecordingEnd::damaged) << "byte " << i;
        }
    }
}

TEST(Recording, AChunkTakenOutOrExchangedIsNoticed) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "edited.plrec";
    const auto chunk = [](std::uint64_t number) {
        return chunk_bytes({chunk_types::kEvent, Instant(number), text(number)}, number);
    };
    put_bytes(file, recording_header() + chunk(0) + chunk(2) + chunk(3));
    RecordingReader taken_out(file);
    EXPECT_EQ(read_all(taken_out).size(), 1u);
    EXPECT_EQ(taken_out.end(), RecordingEnd::damaged);
    put_bytes(file, recording_header() + chunk(0) + chunk(2));
    RecordingReader before_the_last(file);
    EXPECT_EQ(read_all(before_the_last).size(), 1u);
    EXPECT_EQ(before_the_last.end(), RecordingEnd::damaged) << "no cut: the last chunk is whole";
    put_bytes(file, recording_header() + chunk(1) + chunk(0));
    RecordingReader exchanged(file);
    EXPECT_EQ(read_all(exchanged).size(), 0u);
    EXPECT_EQ(exchanged.end(), RecordingEnd::damaged);
}

TEST(Recording, ADiskThatDoesNotGiveItsBytesIsNoCut) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "session.plrec";
    write_recording(file, 3000);  // more than is read at once
    RecordingReader reader(file);
    // What was there when it was opened is gone, as it is behind a bad block or a network that broke.
    fs::resize_file(file, fs::file_size(file) / 2);
    try {
        read_all(reader);
        ADD_FAILURE() << "read to " << reader.bytes_read() << " of " << reader.bytes();
    } catch (const DiskError& fault) {
        EXPECT_NE(std::string(fault.what()).find("cannot be read at byte"), std::string::npos) << fault.what();
    }
    EXPECT_EQ(reader.end(), RecordingEnd::open) << "nothing is known of its end";
}

TEST(Recording, HostileBytesGiveNoChunkOrAWholeOneAndEndSoon) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "hostile.plrec";
    std::mt19937 random(7);
    const auto any = [&](unsigned below) { return static_cast<unsigned>(random() % below); };
    for (int trial = 0; trial < 1000; ++trial) {
        std::string bytes = recording_header();
        for (std::uint64_t i = 0; i < 3; ++i)
            bytes += chunk_bytes({i == 1 ? chunk_types::kFrame : chunk_types::kEvent, Instant(i),
                                  i == 1 ? pack_frame(noisy_frame(i, 8, 4)) : text(i)},
                                 i);
        for (unsigned change = 0; change <= any(4); ++change) {
            const std::size_t at =
                kRecordingHeaderBytes + any(static_cast<unsigned>(bytes.size() - kRecordingHeaderBytes));
            const unsigned kind = any(4);
            if (kind == 0) bytes[at] = static_cast<char>(random());
            if (kind == 1) bytes.resize(at);  // cut
            if (kind == 2) bytes.insert(at, "CHNK");
            if (kind == 3 && at + 4 <= bytes.size()) bytes.replace(at, 4, "\xff\xff\xff\x7f");  // lengths that lie
            if (bytes.size() <= kRecordingHeaderBytes) break;
        }
        put_bytes(file, bytes);
        RecordingReader reader(file);
        for (const RecordingChunk& chunk : read_all(reader))
            if (chunk.type == chunk_types::kFrame) {
                EXPECT_EQ(unpack_frame(chunk.payload, file).number, 1u);
            }
        EXPECT_NE(reader.end(), RecordingEnd::open);
        EXPECT_LE(reader.bytes_read(), bytes.size());
    }
}

/// A chunk that ends a recording is read to be judged, wanted or not: as many as a hostile file has.
TEST(Recording, ManyEndsThatNobodyWantsAreReadOneByOne) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "hostile.plrec";
    std::string bytes = recording_header();
    constexpr std::uint64_t kEnds = 300000;
    for (std::uint64_t i = 0; i < kEnds; ++i) bytes += chunk_bytes({chunk_types::kDone, Instant(0), ""}, i);
    put_bytes(file, bytes);
    RecordingReader reader(file);
    reader.want_only([](const ChunkType& type, Instant) { return type == chunk_types::kEvent; });
    EXPECT_FALSE(reader.next());
    EXPECT_EQ(reader.chunks(), kEnds);
}

// A thousand headers that each promise the rest of the file: read whole one by one that is 50 times the file and more.
TEST(Recording, ASearchForWholeChunksEndsWithItsBudgetAndSaysThatItIsNotKnown) {
    const TemporaryFolder folder;
    const fs::path file = folder.path() / "hostile.plrec";
    std::string lies(std::size_t{1} << 20, 'x');
    for (std::size_t at = 0; at < 1000; ++at) {
        const auto left = static_cast<std::uint32_t>(lies.size() - 64 * at - kChunkHeaderBytes);
        std::string header = chunk_bytes({chunk_types::kEvent, Instant(0), ""}, 7).substr(0, kChunkHeaderBytes);
        std::memcpy(header.data() + 24, &left, sizeof left);
        lies.replace(64 * at, header.size(), header);
    }
    const std::string good = chunk_bytes({chunk_types::kEvent, Instant(0), text(0)}, 0);
    const auto end_of = [&](const std::string& bytes, std::uint64_t budget) {
        put_bytes(file, bytes);
        RecordingReader reader(file);
        reader.search_at_most(budget);
        EXPECT_EQ(read_all(reader).size(), 1u);
        EXPECT_EQ(reader.sentence().empty(), reader.end() == RecordingEnd::whole);
        return reader.end();
    };
    const std::string whole_behind = chunk_bytes({chunk_types::kEvent, Instant(1), text(1)}, 9);
    EXPECT_EQ(end_of(recording_header() + good + lies + whole_behind, 50 << 20), RecordingEnd::unknown);
    EXPECT_EQ(end_of(recording_header() + good + lies + whole_behind, std::uint64_t{2} << 30), RecordingEnd::damaged);
    EXPECT_EQ(end_of(recording_header() + good + lies, std::uint64_t{2} << 30), RecordingEnd::cut);
    EXPECT_EQ(end_of(recording_header() + good + "???" + whole_behind, 50 << 20), RecordingEnd::damaged);
}

TEST(Recording, AFrameThatLiesAboutItsSizeIsRefusedWithoutAskingForItsMemory) {
    std::string bytes = pack_frame(noisy_frame(1, 8, 4));
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::string spoilt = bytes;
        spoilt[at] = static_cast<char>(spoilt[at] ^ 0x7f);
        try {
            const StereoFrame frame = unpack_frame(spoilt, "x");
            EXPECT_LE(frame.left.pixels.size(), 32u * (1u << 17));
        } catch (const DamagedFileError&) {
        }
        try {
            static_cast<void>(unpack_frame(std::string_view(bytes).substr(0, at), "x"));
            ADD_FAILURE() << "cut at " << at;
        } catch (const DamagedFileError&) {
        }
    }
}

TEST(Recording, AFileThatIsNoneIsRefusedByName) {
    const TemporaryFolder folder;
    EXPECT_THROW(RecordingReader{folder.path() / "none.plrec"}, InputError);
    EXPECT_THROW(RecordingReader{folder.path()}, InputError);
    put_bytes(folder.path() / "text.plrec", "This is a letter to the editor.");
    EXPECT_THROW(RecordingReader{folder.path() / "text.plrec"}, InputError);
    std::string newer = recording_header();
    newer[8] = 2;
    put_bytes(folder.path() / "newer.plrec", newer);
    EXPECT_THROW(RecordingReader{folder.path() / "newer.plrec"}, DamagedFileError);
}

}  // namespace
}  // namespace planlight
