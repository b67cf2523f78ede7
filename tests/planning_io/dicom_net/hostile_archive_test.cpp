// An archive that answers what nobody should, and sends what was not asked for.
#include <fstream>

#include "planning_io/case/case_names.h"
#include "planning_io/files/safe_write.h"
#include "tests/planning_io/dicom_net/sending_archive.h"

namespace planlight {
namespace {

namespace fs = std::filesystem;
using test::Answer;
using test::SendingArchive;

class HostileArchive : public SendingArchive {};

TEST_F(HostileArchive, ThatNamesAnImageByAPathIsRefused) {
    for (const char* uid : {"../../elsewhere", "/tmp/elsewhere", "1.2/3", "..", ".", "", "1.2.3\\1.2.4", "1.2 3"}) {
        answers_[3]["SOPInstanceUID"] = uid;
        begin([&] { return send(us()); });
        expect_refused<CheckFailedError>("without a right UID");
    }
}

TEST_F(HostileArchive, WhatItSendsWithoutBeingAskedIsThrownAway) {
    answers_.erase(answers_.begin() + 20, answers_.end());
    begin([&] { return send(us()); });
    EXPECT_EQ(fetch(), 20u);
    EXPECT_EQ(files_that_came(), 20u);
}

/// The second may be another image, or cut.
TEST_F(HostileArchive, AnImageThatComesTwiceIsTakenOnce) {
    const fs::path other = folder_.path() / "other.dcm";
    std::string changed = read_whole(files_[0]);
    changed.back() = static_cast<char>(~changed.back());
    std::ofstream(other, std::ios::binary) << changed;
    begin([&] {
        const unsigned status = send(us());
        store_objects(us(), {other});
        return status;
    });
    EXPECT_EQ(fetch(), files_.size());
    EXPECT_EQ(files_that_came(), files_.size());
    const fs::path first = got_ / (answers_[0]["SOPInstanceUID"] + ".dcm");
    EXPECT_EQ(read_whole(first).back(), read_whole(files_[0]).back());
}

TEST_F(HostileArchive, ThatListsAnImageTwiceIsAskedForItOnce) {
    answers_.push_back(answers_[0]);
    begin([&] { return send(us()); });
    EXPECT_EQ(fetch(), files_.size());
}

TEST_F(HostileArchive, ThatSaysItSentWhatDidNotComeIsNotBelieved) {
    begin([&] {
        store_objects(us(), {files_[0], files_[1]});
        return kDone;
    });
    expect_refused<CheckFailedError>("sent 2 of the 24 images");
}

Answer answer_of_a_series(const std::string& character_set, const std::string& name) {
    return {{"SpecificCharacterSet", character_set},
            {"PatientName", name},
            {"StudyInstanceUID", "1.2.3"},
            {"SeriesInstanceUID", "1.2.3.4"}};
}

TEST_F(HostileArchive, NamesInAnyCharacterSetAreReadable) {
    const std::string ivanov = "\xd0\x98\xd0\xb2\xd0\xb0\xd0\xbd\xd0\xbe\xd0\xb2";
    answers_ = {answer_of_a_series("ISO_IR 144", "\xb8\xd2\xd0\xdd\xde\xd2"), answer_of_a_series("ISO_IR 192", ivanov),
                answer_of_a_series("ISO_IR 100", "M\xfcller"), answer_of_a_series("NO SUCH SET", "M\xfcller")};
    begin([] { return 0u; });
    SeriesQuery query;
    query.series_uid = "1.2.3.4";
    std::vector<std::string> names;
    for (const FoundSeries& series : find_series(peer_, query)) names.push_back(series.patient_name);
    ASSERT_EQ(names.size(), 4u);
    EXPECT_EQ(names[0], ivanov);
    EXPECT_EQ(names[1], ivanov);
    EXPECT_EQ(names[2], "M\xc3\xbcller");
    EXPECT_EQ(without_control_characters(names[3]), "M?ller") << "as it is printed: in no character set that is known";
}

TEST_F(HostileArchive, AStudyThatIsNamedByAPathIsNotListed) {
    answers_ = {{{"StudyInstanceUID", "../../elsewhere"}, {"SeriesInstanceUID", "1.2.3"}},
                {{"StudyInstanceUID", "1.2.3"}, {"SeriesInstanceUID", "../../elsewhere"}}};
    begin([] { return 0u; });
    SeriesQuery query;
    query.series_uid = "1.2.3";
    EXPECT_TRUE(find_series(peer_, query).empty());
}

TEST_F(HostileArchive, ThatAnswersWithoutAnEndIsLeft) {
    answers_.assign(1, answer_of_a_series("", "ANYBODY"));
    test::ScriptedArchive::Script script{answers_, [] { return 0u; }, {}};
    script.without_end = true;
    archive_ = std::make_unique<test::ScriptedArchive>(script);
    peer_ = archive_->peer();
    peer_.most_answers = 100;
    try {
        find_series(peer_, {});
        FAIL() << "it has an end";
    } catch (const CheckFailedError& fault) {
        EXPECT_NE(std::string(fault.what()).find("more than 100 answers"), std::string::npos) << fault.what();
    }
}

}  // namespace
}  // namespace planlight
