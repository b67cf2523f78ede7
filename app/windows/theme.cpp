#include "app/windows/theme.h"

namespace planlight {
namespace {

constexpr ImU32 rgb(int r, int g, int b) {
    return IM_COL32(r, g, b, 255);
}

const Theme& dark_theme() {
    static const Theme theme = [] {
        Theme t{};
        t.background = rgb(11, 13, 17), t.panel = rgb(18, 21, 28), t.edge = rgb(38, 44, 56);
        t.text = rgb(232, 236, 242), t.quiet = rgb(150, 160, 176);
        t.green = rgb(46, 216, 156), t.amber = rgb(250, 184, 40), t.red = rgb(255, 108, 108),
        t.blue = rgb(72, 150, 240);
        t.active = rgb(26, 72, 120), t.control = rgb(38, 46, 60), t.hovered = rgb(52, 64, 84);
        t.control_edge = rgb(96, 112, 140), t.leads_edge = rgb(130, 190, 255);
        t.disabled = rgb(22, 25, 32), t.disabled_text = rgb(128, 136, 150), t.done = rgb(31, 142, 86);
        t.badge = rgb(222, 226, 234), t.badge_edge = rgb(255, 255, 255), t.badge_text = rgb(12, 14, 18);
        t.badge_quiet = rgb(52, 58, 70), t.badge_hovered = rgb(255, 255, 255), t.badge_held = rgb(150, 156, 168);
        t.swatch_edge = t.panel;
        const ImU32 white = rgb(255, 255, 255);
        const BannerLook at_rest{rgb(26, 31, 40), rgb(120, 134, 158), rgb(160, 172, 192), t.text, white};
        const BannerLook busy{rgb(14, 36, 66), t.blue, t.blue, rgb(220, 236, 255), white};
        const BannerLook check{rgb(62, 46, 8), t.amber, t.amber, rgb(255, 240, 205), white};
        t.banner = {at_rest,
                    busy,
                    busy,
                    {rgb(8, 58, 48), rgb(36, 192, 138), t.green, rgb(222, 255, 236), white},
                    check,
                    {rgb(70, 18, 20), t.red, t.red, rgb(255, 225, 225), white},
                    {rgb(38, 28, 31), rgb(158, 104, 110), rgb(168, 112, 118), rgb(240, 222, 224), white},
                    at_rest};
        t.notice = check;
        return t;
    }();
    return theme;
}

/// For a bright room, in which a dark screen mirrors the lamps.
const Theme& bright_theme() {
    static const Theme theme = [] {
        Theme t{};
        t.background = rgb(214, 220, 229), t.panel = rgb(248, 250, 253), t.edge = rgb(158, 168, 184);
        t.text = rgb(14, 18, 26), t.quiet = rgb(68, 78, 96);
        t.green = rgb(0, 96, 76), t.amber = rgb(128, 70, 0), t.red = rgb(172, 14, 24), t.blue = rgb(18, 88, 186);
        t.active = rgb(176, 209, 248), t.control = rgb(226, 231, 239), t.hovered = rgb(204, 213, 227);
        t.control_edge = rgb(92, 106, 132), t.leads_edge = rgb(18, 88, 186);
        t.disabled = rgb(232, 235, 240), t.disabled_text = rgb(92, 100, 114), t.done = rgb(0, 112, 62);
        t.badge = rgb(22, 26, 34), t.badge_edge = rgb(0, 0, 0), t.badge_text = rgb(255, 255, 255);
        t.badge_quiet = rgb(206, 212, 222), t.badge_hovered = rgb(58, 66, 82), t.badge_held = rgb(92, 102, 122);
        t.swatch_edge = rgb(60, 68, 84);
        const auto look = [](ImU32 fill, ImU32 shape, ImU32 text) {
            return BannerLook{fill, shape, shape, text, text};
        };
        // Grey enough that eyes without green do not take it for the green of ALIGNED.
        const BannerLook at_rest = look(rgb(166, 170, 180), rgb(28, 33, 44), rgb(12, 16, 24));
        const BannerLook busy = look(rgb(222, 216, 255), rgb(60, 40, 190), rgb(24, 14, 84));
        const BannerLook check = look(rgb(255, 218, 128), rgb(146, 82, 0), rgb(62, 36, 0));
        t.banner = {at_rest,
                    busy,
                    busy,
                    look(rgb(184, 240, 226), rgb(0, 108, 92), rgb(2, 46, 36)),
                    check,
                    look(rgb(255, 200, 200), rgb(176, 14, 24), rgb(84, 4, 10)),
                    // No light: dark in a bright window too.
                    {rgb(54, 42, 46), rgb(22, 16, 18), rgb(206, 158, 164), rgb(244, 230, 232), rgb(255, 255, 255)},
                    at_rest};
        t.notice = check;
        return t;
    }();
    return theme;
}

}  // namespace

const Theme& theme_of(ThemeKind kind) {
    return kind == ThemeKind::bright ? bright_theme() : dark_theme();
}

}  // namespace planlight
