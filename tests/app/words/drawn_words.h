#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "app/windows/layout.h"
#include "app/windows/pen.h"
#include "app/words/words.h"

struct ImGuiContext;

namespace planlight {

/// A window without a display: it is laid out and drawn into a list, which nobody sees.
class DrawnWords {
public:
    DrawnWords(const std::string& language, int width, int height);
    ~DrawnWords();
    DrawnWords(const DrawnWords&) = delete;
    DrawnWords& operator=(const DrawnWords&) = delete;

    /// An empty list to draw into, in which nothing was cut yet.
    void begin();

private:
    void end();
    ImGuiContext* const context_;
    bool drawing_ = false;
    std::shared_ptr<const Words> words_;

public:
    const WindowLayout place;
    std::vector<std::string> cut;
    std::set<unsigned> lacking;
    Pen pen{};
};

/// From the least that a window may have, upright and on end, to the largest monitors.
inline constexpr std::pair<int, int> kSizes[] = {{800, 600},   {1024, 768}, {1280, 720},  {1366, 768}, {1920, 1080},
                                                 {3840, 2160}, {600, 800},  {1080, 1920}, {720, 1280}};

/// Tests of what is drawn, in every language at every size; the fonts of each are made once for all of them.
class DrawnInPlace : public testing::TestWithParam<std::tuple<std::string, std::pair<int, int>>> {
protected:
    DrawnInPlace();
    int width() const { return std::get<1>(GetParam()).first; }
    int height() const { return std::get<1>(GetParam()).second; }
    /// Nothing was cut since the last call, and no letter lacked a sign.
    void expect_whole(const std::string& where);

    DrawnWords& drawn_;
};

inline auto every_language_and_size() {
    return testing::Combine(testing::Values("en", "de", "ru"), testing::ValuesIn(kSizes));
}

}  // namespace planlight
