#include "projection/stroke_font.h"

#include <algorithm>
#include <map>

namespace planlight {
namespace {

constexpr double kUnits = 6;  // grid units of a capital's height

// Each sign as points "xy" on a grid, lines parted by ';'. Baseline at y = 2, capitals to 8, small letters to 6.
const std::map<char32_t, const char*>& shapes() {
    static const std::map<char32_t, const char*> kShapes{
        {'A', "02 28 42;15 35"},
        {'B', "02 08 38 47 46 35 05;35 44 43 32 02"},
        {'C', "47 38 18 07 03 12 32 43"},
        {'D', "02 08 28 46 44 22 02"},
        {'E', "48 08 02 42;05 35"},
        {'F', "48 08 02;05 35"},
        {'G', "47 38 18 07 03 12 32 43 45 25"},
        {'H', "02 08;42 48;05 45"},
        {'I', "08 28;18 12;02 22"},
        {'J', "48 43 32 12 03"},
        {'K', "02 08;48 05 42"},
        {'L', "08 02 42"},
        {'M', "02 08 35 68 62"},
        {'N', "02 08 42 48"},
        {'O', "12 03 07 18 38 47 43 32 12"},
        {'P', "02 08 38 47 46 35 05"},
        {'Q', "12 03 07 18 38 47 43 32 12;24 42"},
        {'R', "02 08 38 47 46 35 05;25 42"},
        {'S', "47 38 18 07 06 15 35 44 43 32 12 03"},
        {'T', "08 48;28 22"},
        {'U', "08 03 12 32 43 48"},
        {'V', "08 22 48"},
        {'W', "08 12 36 52 68"},
        {'X', "08 42;02 48"},
        {'Y', "08 25 48;25 22"},
        {'Z', "08 48 02 42"},
        {'0', "12 03 07 18 28 37 33 22 12"},
        {'1', "06 28 22;02 42"},
        {'2', "07 18 38 47 46 02 42"},
        {'3', "07 18 38 47 46 35 15;35 44 43 32 12 03"},
        {'4', "32 38 04 44"},
        {'5', "48 08 05 16 36 45 43 32 12 03"},
        {'6', "38 18 06 03 12 32 43 44 35 15 04"},
        {'7', "08 48 12"},
        {'8', "15 06 07 18 38 47 46 35 15 04 03 12 32 43 44 35"},
        {'9', "12 32 44 47 38 18 07 06 15 35 46"},
        {'a', "05 16 26 35 32;34 14 03 12 22 33"},
        {'b', "08 02;05 16 26 35 33 22 12 03"},
        {'c', "35 26 16 05 03 12 22 33"},
        {'d', "38 32;35 26 16 05 03 12 22 33"},
        {'e', "04 34 35 26 16 05 03 12 22 33"},
        {'f', "38 28 17 12;06 26"},
        {'g', "36 31 20 10 01;35 26 16 05 03 12 22 33"},
        {'h', "08 02;05 16 26 35 32"},
        {'i', "06 02;08 07"},
        {'j', "26 21 10 00;28 27"},
        {'k', "08 02;36 04 32"},
        {'l', "08 03 12"},
        {'m', "06 02;05 16 26 35 32;35 46 56 65 62"},
        {'n', "06 02;05 16 26 35 32"},
        {'o', "16 05 03 12 22 33 35 26 16"},
        {'p', "06 00;05 16 26 35 33 22 12 03"},
        {'q', "36 30;35 26 16 05 03 12 22 33"},
        {'r', "06 02;04 16 26"},
        {'s', "36 16 05 14 24 33 22 02"},
        {'t', "18 13 22 32;06 36"},
        {'u', "06 03 12 22 33;36 32"},
        {'v', "06 22 46"},
        {'w', "06 12 26 32 46"},
        {'x', "06 32;02 36"},
        {'y', "06 22;46 10"},
        {'z', "06 36 02 32"},
        {'.', "02 03"},
        {',', "13 12 01"},
        {'-', "05 35"},
        {'+', "05 45;23 27"},
        {'/', "02 48"},
        {'\\', "08 42"},
        {'(', "28 17 13 22"},
        {')', "08 17 13 02"},
        {'[', "18 08 02 12"},
        {']', "08 18 12 02"},
        {':', "02 03;05 06"},
        {';', "13 12 01;15 16"},
        {'_', "02 42"},
        {'=', "04 44;06 46"},
        {'?', "07 18 38 47 46 25 24;22 23"},
        {'!', "08 04;02 03"},
        {'#', "12 18;32 38;04 44;06 46"},
        {'\'', "08 06"},
        {'"', "08 06;18 16"},
        {'<', "36 04 32"},
        {'>', "06 34 02"},
        {'*', "03 47;07 43;05 45"},
        {'%', "02 48;08 18 17 07 08;33 43 42 32 33"},
        {'&', "42 07 18 27 04 03 12 22 44"},
        {'|', "08 02"},
        {'~', "04 15 24 35"},
        {'^', "06 28 46"},
        {'$', "47 38 18 07 06 15 35 44 43 32 12 03;28 22"},
        {'@', "34 24 25 35 33 43 46 37 17 06 03 12 42"},
        {0x00B0, "18 27 16 07 18"},                    // degree
        {0x2300, "13 04 06 17 37 46 44 33 13;02 48"},  // diameter
        {0x00DF, "02 07 18 28 37 36 25 34 33 22 12"},  // sharp s
        {0x00B5, "06 00;03 12 22 33;36 32"},           // micro
    };
    return kShapes;
}

struct Composed {
    char32_t base;
    const char* accent;  // above a small letter; one unit higher above a capital
};

const std::map<char32_t, Composed>& composed() {
    static const char* kDots = "07 08;27 28";
    static const char* kAcute = "17 28";
    static const char* kGrave = "08 17";
    static const char* kHat = "07 18 27";
    static const std::map<char32_t, Composed> kComposed{
        {0xE4, {'a', kDots}},  {0xF6, {'o', kDots}},  {0xFC, {'u', kDots}},  {0xC4, {'A', kDots}},
        {0xD6, {'O', kDots}},  {0xDC, {'U', kDots}},  {0xEB, {'e', kDots}},  {0xE9, {'e', kAcute}},
        {0xE1, {'a', kAcute}}, {0xF3, {'o', kAcute}}, {0xFA, {'u', kAcute}}, {0xED, {'i', kAcute}},
        {0xE8, {'e', kGrave}}, {0xE0, {'a', kGrave}}, {0xEA, {'e', kHat}},   {0xE2, {'a', kHat}},
        {0xF4, {'o', kHat}},   {0xF1, {'n', kHat}},   {0xC9, {'E', kAcute}},
    };
    return kComposed;
}

void add_lines(const char* shape, double rise, Glyph& to) {
    to.lines.emplace_back();
    for (const char* c = shape; *c != '\0';) {
        if (*c == ';') {
            to.lines.emplace_back();
            ++c;
        } else if (*c == ' ') {
            ++c;
        } else {
            to.lines.back().emplace_back((c[0] - '0') / kUnits, (c[1] - '0' - 2 + rise) / kUnits);
            c += 2;
        }
    }
}

void set_width(Glyph& g) {
    double left = 1e9, right = -1e9;
    for (const auto& line : g.lines)
        for (const auto& p : line) {
            left = std::min(left, p.x());
            right = std::max(right, p.x());
        }
    for (auto& line : g.lines)
        for (auto& p : line) p.x() -= left;
    g.width = right - left;
    g.advance = g.width + 1.8 / kUnits;
}

}  // namespace

Glyph glyph(char32_t code) {
    if (code == 0xD8 || code == 0xF8 || code == 0x2205)
        code = 0x2300;  // O with stroke and empty set, used for diameter
    if (code == ' ' || code == 0xA0) return {{}, 0, 2.6 / kUnits};
    Glyph g;
    if (const auto made = composed().find(code); made != composed().end()) {
        const bool capital = made->second.base < 'a';
        g = glyph(made->second.base);
        add_lines(made->second.accent, capital ? 1.5 : 0, g);
    } else {
        const auto found = shapes().find(code);
        add_lines(found != shapes().end() ? found->second : shapes().at('?'), 0, g);
    }
    set_width(g);
    return g;
}

bool is_known_glyph(char32_t code) {
    return code == ' ' || code == 0xA0 || code == 0xD8 || code == 0xF8 || code == 0x2205 || composed().contains(code) ||
           shapes().contains(code);
}

std::u32string code_points(const std::string& utf8) {
    std::u32string out;
    for (std::size_t i = 0; i < utf8.size();) {
        const auto lead = static_cast<unsigned char>(utf8[i++]);
        const int more = lead < 0x80 ? 0 : lead >= 0xF0 && lead < 0xF8 ? 3 : lead >= 0xE0 ? 2 : lead >= 0xC0 ? 1 : -1;
        char32_t code = more == 0 ? lead : more > 0 ? lead & (0x3Fu >> more) : 0xFFFD;
        for (int k = 0; k < more; ++k) {
            const bool continues = i < utf8.size() && (static_cast<unsigned char>(utf8[i]) & 0xC0) == 0x80;
            if (!continues) {
                code = 0xFFFD;
                break;
            }
            code = (code << 6) | (static_cast<unsigned char>(utf8[i++]) & 0x3F);
        }
        out.push_back(code);
    }
    return out;
}

double text_width(const std::u32string& text) {
    double width = 0, ink = 0;
    for (const char32_t code : text) {
        const Glyph g = glyph(code);
        ink = width + g.width;
        width += g.advance;
    }
    return ink;
}

}  // namespace planlight
