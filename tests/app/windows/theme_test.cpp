// The colours of the window: every text is read on its ground, by eyes of every kind. WCAG 2.1 (1.4.3, 1.4.6) for the
// contrast; colour blindness after Machado, Oliveira & Fernandes (2009), severity 1.
#include "app/windows/theme.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "app/windows/operator_model.h"

namespace planlight {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Linear red, green and blue, 0 to 1.
Vector3d linear(ImU32 colour) {
    const auto channel = [&](int shift) {
        const double c = static_cast<double>((colour >> shift) & 255U) / 255;
        return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    };
    return {channel(IM_COL32_R_SHIFT), channel(IM_COL32_G_SHIFT), channel(IM_COL32_B_SHIFT)};
}

struct Eye {
    std::string name;
    Matrix3d sees;
};

const std::vector<Eye>& eyes() {
    static const std::vector<Eye> all = [] {
        Matrix3d protan, deutan, tritan;
        protan << 0.152286, 1.052583, -0.204868, 0.114503, 0.786281, 0.099216, -0.003882, -0.048116, 1.051998;
        deutan << 0.367322, 0.860646, -0.227968, 0.280085, 0.672501, 0.047413, -0.011820, 0.042940, 0.968881;
        tritan << 1.255528, -0.076749, -0.178779, -0.078411, 0.930809, 0.147602, 0.004733, 0.691367, 0.303900;
        return std::vector<Eye>{
            {"all colours", Matrix3d::Identity()}, {"no red", protan}, {"no green", deutan}, {"no blue", tritan}};
    }();
    return all;
}

Vector3d seen(const Eye& eye, ImU32 colour) {
    return (eye.sees * linear(colour)).cwiseMax(0).cwiseMin(1);
}

double luminance(const Vector3d& rgb) {
    return rgb.dot(Vector3d(0.2126, 0.7152, 0.0722));
}

double contrast(const Eye& eye, ImU32 a, ImU32 b) {
    const double one = luminance(seen(eye, a)), other = luminance(seen(eye, b));
    return (std::max(one, other) + 0.05) / (std::min(one, other) + 0.05);
}

/// How different two colours look (CIE 1976, D65).
double difference(const Eye& eye, ImU32 a, ImU32 b) {
    const auto lab = [&](ImU32 colour) {
        Matrix3d to_xyz;
        to_xyz << 0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505;
        const Vector3d xyz = (to_xyz * seen(eye, colour)).cwiseQuotient(Vector3d(0.9505, 1, 1.089));
        const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116; };
        return Vector3d(116 * f(xyz.y()) - 16, 500 * (f(xyz.x()) - f(xyz.y())), 200 * (f(xyz.y()) - f(xyz.z())));
    };
    return (lab(a) - lab(b)).norm();
}

class Themes : public testing::TestWithParam<ThemeKind> {
protected:
    const Theme& theme_ = theme_of(GetParam());
    void expect_read(const std::string& what, ImU32 text, ImU32 ground, double least) const {
        for (const Eye& eye : eyes())
            EXPECT_GE(contrast(eye, text, ground), least) << what << ", eyes that see " << eye.name;
    }
};
INSTANTIATE_TEST_SUITE_P(All, Themes, testing::Values(ThemeKind::dark, ThemeKind::bright),
                         [](const auto& of) { return of.param == ThemeKind::dark ? "Dark" : "Bright"; });

constexpr double kText = 4.5, kRead = 7, kMark = 3;  // small text at least; what is read at four metres; shapes

TEST_P(Themes, EveryTextStandsOutFromItsGround) {
    const Theme& t = theme_;
    for (const ImU32 ground : {t.background, t.panel, t.control, t.hovered, t.active})
        expect_read("text", t.text, ground, kRead);
    for (const ImU32 ground : {t.background, t.panel, t.control, t.disabled})
        expect_read("quiet text", t.quiet, ground, kText);
    expect_read("the label of a button that does nothing", t.disabled_text, t.disabled, kText);
    for (const ImU32 ink : {t.green, t.amber, t.red}) expect_read("a figure", ink, t.panel, kText);
    expect_read("the line under the patient's name", t.amber, t.background, kText);
    expect_read("DARK", t.badge_text, t.badge, kRead);
    expect_read("DARK, hovered", t.badge_text, t.badge_hovered, kRead);
    expect_read("DARK, held", t.badge_text, t.badge_held, kText);
    expect_read("the keys of DARK", t.badge_quiet, t.badge, kRead);
    expect_read("the number of a step that warns", t.panel, t.amber, kText);
    for (const BannerLook& look : t.banner) {
        expect_read("the banner's word", look.text, look.fill, kRead);
        expect_read("the banner's sentence", look.strong, look.fill, kRead);
        expect_read("the banner's shape", look.shape, look.fill, kMark);
    }
    expect_read("an answer", t.notice.text, t.notice.fill, kRead);
}

TEST_P(Themes, AButtonIsSeenFromTheGroundAndTheOneThatLeadsOnFromTheOthers) {
    const Theme& t = theme_;
    expect_read("a button's edge", t.control_edge, t.panel, kMark);
    expect_read("the edge of the one that leads on", t.leads_edge, t.panel, kMark);
    expect_read("DARK", t.badge, t.background, kRead);
    expect_read("a marked row", t.blue, t.panel, kMark);
    for (const Eye& eye : eyes()) EXPECT_GT(difference(eye, t.active, t.control), 15) << eye.name;
}

// Words and shapes differ too; but who only sees the colour from afar must not take one for ALIGNED.
TEST_P(Themes, AlignedLooksLikeNoOtherStateToAnyEye) {
    const auto of = [&](StatusKind kind) { return theme_.banner[static_cast<std::size_t>(kind)]; };
    for (const StatusKind other : {StatusKind::ready, StatusKind::scanning, StatusKind::matching, StatusKind::check,
                                   StatusKind::refused, StatusKind::dark, StatusKind::waiting})
        for (const Eye& eye : eyes()) {
            const double fill = difference(eye, of(StatusKind::aligned).fill, of(other).fill),
                         shape = difference(eye, of(StatusKind::aligned).shape, of(other).shape);
            EXPECT_GT(std::max(fill, shape), 20) << static_cast<int>(other) << ", " << eye.name;
        }
}

// Pictures are dark in every theme, and so are the words on them read.
TEST(PictureWords, AreReadInEveryTheme) {
    const Eye& all = eyes().front();
    EXPECT_GE(contrast(all, on_pictures().text, IM_COL32(10, 12, 16, 255)), kRead);
    EXPECT_GE(contrast(all, on_pictures().amber, IM_COL32(10, 12, 16, 255)), kRead);
}

}  // namespace
}  // namespace planlight
