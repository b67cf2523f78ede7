// Every kind of message byte for byte, as the OpenIGTLink protocol (version 2, http://openigtlink.org/protocols) has
// it. The bytes were written out from the protocol's tables, not by the library: header of 58 bytes (version 1, type in
// 12, device in 20, moment as 32.32 bit seconds, size of the body, CRC-64 of the body by ECMA-182), then the body, all
// with the most significant byte first.
#include "app/igtl/igtl_messages.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <bit>
#include <numbers>

#include "app/igtl/linked_shapes.h"

namespace planlight {
namespace {

using Eigen::Vector3d;

constexpr double kUtc_s = 1.5;  // 00000001 80000000

std::string hex_of(const std::string& bytes) {
    std::string text;
    for (const char byte : bytes) text += fmt::format("{:02x}", static_cast<unsigned char>(byte));
    return text;
}

/// A quarter turn about the first axis, and a shift; LPS. In RAS the second and third of its axes turn the other way.
RigidTransform quarter_turn() {
    RigidTransform t = RigidTransform::Identity();
    t.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitX()).toRotationMatrix().array().round();
    t.translation() = Vector3d(10, 20, 30);
    return t;
}

/// The CRC of ECMA-182, bit by bit.
std::uint64_t crc_of(const std::string& bytes) {
    std::uint64_t crc = 0;
    for (const char byte : bytes) {
        crc ^= static_cast<std::uint64_t>(static_cast<unsigned char>(byte)) << 56;
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 63 ? crc << 1 ^ 0x42F0E1EBA9EA3693 : crc << 1;
    }
    return crc;
}

float number_at(const std::string& bytes, std::size_t at) {
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < 4; ++i) bits = bits << 8 | static_cast<unsigned char>(bytes[at + i]);
    return std::bit_cast<float>(bits);
}

TEST(IgtlMessages, ATransformIsAsTheProtocolHasIt) {
    // The matrix column by column, then the shift, in 32 bit.
    EXPECT_EQ(hex_of(transform_message({"T_global", kUtc_s}, quarter_turn())),
              "00015452414e53464f524d000000545f676c6f62616c0000000000000000000000000000000180000000000000000000"
              "0030b2a9b0d55e230dc63f80000000000000000000000000000000000000bf800000000000003f80000000000000c120"
              "0000c1a0000041f00000");
}

TEST(IgtlMessages, TransformsOfOneMomentAreAsTheProtocolHasThem) {
    // Each: name in 20, type 2 (6D), a byte in reserve, the matrix.
    EXPECT_EQ(
        hex_of(tracking_message({"Poses", kUtc_s}, {{"T_ini", quarter_turn()}, {"T_cur", RigidTransform::Identity()}})),
        "0001544441544100000000000000506f7365730000000000000000000000000000000000000180000000000000000000"
        "008c6d79f0be74a07054545f696e6900000000000000000000000000000002003f800000000000000000000000000000"
        "00000000bf800000000000003f80000000000000c1200000c1a0000041f00000545f6375720000000000000000000000"
        "0000000002003f8000000000000000000000000000003f8000000000000000000000000000003f800000000000000000"
        "000000000000");
}

TEST(IgtlMessages, AStatusIsAsTheProtocolHasIt) {
    // Code 13 (not ready), subcode, word in 20, text with a zero behind it.
    EXPECT_EQ(hex_of(status_message({"Gate", kUtc_s}, LinkCode::not_ready, 1, "look", "Look.")),
              "000153544154555300000000000047617465000000000000000000000000000000000000000180000000000000000000"
              "0024bacb45a7cfff77cd000d00000000000000016c6f6f6b000000000000000000000000000000004c6f6f6b2e00");
}

TEST(IgtlMessages, LengthsAreASensorsInMillimetres) {
    // Two numbers; unit: prefix B (milli), then metre (01) to the power of 1, 4 + 6 + 4 bits from the top.
    EXPECT_EQ(hex_of(lengths_message({"LightError", kUtc_s}, {0.25, 0.125})),
              "000153454e534f520000000000004c696768744572726f72000000000000000000000000000180000000000000000000"
              "001a6a531343d47112fb0200b0440000000000003fd00000000000003fc0000000000000");
}

TEST(IgtlMessages, AStringIsUtf8) {
    // Character set 106, 2 bytes.
    EXPECT_EQ(hex_of(string_message({"Case", kUtc_s}, "E.")),
              "0001535452494e4700000000000043617365000000000000000000000000000000000000000180000000000000000000"
              "000608096cdf1f85f506006a0002452e");
}

TEST(IgtlMessages, ShapesArePolydata) {
    // Ten counts, four points (LPS turned to RAS), a vertex, a line, a polygon, one number of each cell: "item".
    LinkedShapes shapes;
    shapes.points_in_ct = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {0, 0, 0}};
    shapes.dots = {3};
    shapes.lines = {{0, 1}};
    shapes.triangles = {{0, 1, 2}};
    shapes.number_name = "item";
    shapes.numbers_of_cells = {0, 1, 2};
    std::string bytes = hex_of(shapes_message({"Plan", kUtc_s}, shapes));
    EXPECT_EQ(bytes,
              "0001504f4c594441544100000000506c616e000000000000000000000000000000000000000180000000000000000000"
              "0094bef48e2588aac566000000040000000100000008000000010000000c000000010000001000000000000000000000"
              "0001bf800000c000000040400000c0800000c0a0000040c00000c0e00000c10000004110000000000000000000000000"
              "00000000000100000003000000020000000000000001000000030000000000000001000000021001000000036974656d"
              "0000000000003f80000040000000");
}

TEST(IgtlMessages, TheCheckIsTheBodys) {
    const std::string message = transform_message({"T_cur", 1e9}, quarter_turn());
    std::uint64_t told = 0;
    for (std::size_t i = 50; i < 58; ++i) told = told << 8 | static_cast<unsigned char>(message[i]);
    EXPECT_EQ(told, crc_of(message.substr(58)));
}

TEST(IgtlMessages, APointOfTheCtIsSentWhereSlicerHasIt) {
    // A point in LPS, moved by the transform in LPS and then read as RAS, is the same as read as RAS first and moved by
    // the transform that is sent.
    RigidTransform b_from_a = RigidTransform::Identity();
    b_from_a.linear() = Eigen::AngleAxisd(0.7, Vector3d(1, 2, -3).normalized()).toRotationMatrix();
    b_from_a.translation() = Vector3d(-12.5, 40, 800);
    const std::string message = transform_message({"T_global", kUtc_s}, b_from_a);
    Eigen::Matrix<double, 3, 4> sent;
    for (std::size_t i = 0; i < 12; ++i)
        sent(static_cast<Eigen::Index>(i % 3), static_cast<Eigen::Index>(i / 3)) = number_at(message, 58 + 4 * i);
    const Vector3d p(63, -21, 117), p_in_b = b_from_a * p;
    const Vector3d p_ras(-63, 21, 117), sent_ras = sent * p_ras.homogeneous();
    EXPECT_LT((sent_ras - Vector3d(-p_in_b.x(), -p_in_b.y(), p_in_b.z())).norm(), 2e-4);  // 32 bit at 800 mm
}

TEST(IgtlMessages, ALongNameOfADeviceIsCut) {
    const std::string message = string_message({"A name of more than twenty bytes", kUtc_s}, "");
    EXPECT_EQ(message.substr(14, 20), std::string("A name of more than twenty bytes").substr(0, 20));
}

TEST(IgtlMessages, APlanIsSentWithoutItsNames) {
    Plan plan;
    plan.osteotomy_lines.push_back({"Erika Mustermann", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, true, {}});
    plan.trajectories.push_back({"Erika 2", {0, 0, 0}, {0, 0, 9}, 1, {}});
    plan.boreholes.push_back({"Erika 3", {5, 5, 5}, Vector3d(0, 0, 1), 3, 8, {}});
    plan.boreholes.push_back({"Erika 4", {6, 5, 5}, {}, 3, 8, {}});
    plan.cut_planes.push_back({"Erika 5", {0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 10, 20, {}});
    const LinkedShapes shapes = shapes_of(plan);
    EXPECT_EQ(shapes_message({"Plan", kUtc_s}, shapes).find("Erika"), std::string::npos);
    EXPECT_EQ(shapes.dots.size(), 2u);
    ASSERT_EQ(shapes.lines.size(), 4u);
    EXPECT_EQ(shapes.lines[0], (std::vector<std::uint32_t>{0, 1, 2, 0}));  // closed
    EXPECT_EQ(shapes.numbers_of_cells, (std::vector<float>{2, 3, 0, 1, 2, 4}));
    const auto& border = shapes.lines[3];
    ASSERT_EQ(border.size(), 5u);
    EXPECT_NEAR((shapes.points_in_ct[border[1]] - shapes.points_in_ct[border[0]]).norm(), 10, 1e-12);
    EXPECT_NEAR((shapes.points_in_ct[border[2]] - shapes.points_in_ct[border[1]]).norm(), 20, 1e-12);
}

}  // namespace
}  // namespace planlight
