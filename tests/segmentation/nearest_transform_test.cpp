#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <stdexcept>

#include "segmentation/nearest_transform.h"

namespace planlight::test {
namespace {

SkinPoint skin_at(int i, int j, int k) {
    return {Eigen::Vector3f::Zero(),
            Eigen::Vector3f::UnitZ(),
            {static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), static_cast<std::uint16_t>(k)}};
}

/// A table whose skin voxels are those `is_skin` says.
SkinLut table(std::array<int, 3> size, const std::function<bool(int, int, int)>& is_skin) {
    SkinLut lut;
    lut.size = size;
    lut.voxel_mm = 1;
    for (int k = 0; k < size[2]; ++k)
        for (int j = 0; j < size[1]; ++j)
            for (int i = 0; i < size[0]; ++i)
                if (is_skin(i, j, k)) lut.skin.push_back(skin_at(i, j, k));
    return lut;
}

/// The first of the nearest skin voxels, by trying all.
class ByTrying {
public:
    explicit ByTrying(const SkinLut& lut) {
        for (const auto& s : lut.skin) {
            x_.push_back(s.voxel[0]);
            y_.push_back(s.voxel[1]);
            z_.push_back(s.voxel[2]);
        }
    }
    std::uint32_t nearest(int i, int j, int k) const {
        std::int64_t least = INT64_MAX;
        std::size_t found = 0;
        for (std::size_t s = 0; s < x_.size(); ++s) {
            const std::int64_t a = x_[s] - i, b = y_[s] - j, c = z_[s] - k, squared = a * a + b * b + c * c;
            if (squared >= least) continue;
            least = squared;
            found = s;
        }
        return static_cast<std::uint32_t>(found);
    }

private:
    std::vector<int> x_, y_, z_;
};

struct Shape {
    const char* name;
    SkinLut lut;
};

SkinLut sparse(std::array<int, 3> size, double share, unsigned seed) {
    std::mt19937 random(seed);
    std::bernoulli_distribution is(share);
    return table(size, [&](int, int, int) { return is(random); });
}

/// Small tables of every kind: lanes come in 4, 8, 16 and 32, so sizes stand below, on and above those.
std::vector<Shape> small_shapes() {
    std::vector<Shape> shapes;
    shapes.push_back({"one voxel", table({1, 1, 1}, [](int, int, int) { return true; })});
    shapes.push_back(
        {"one point", table({37, 41, 29}, [](int i, int j, int k) { return i == 36 && j == 0 && k == 11; })});
    shapes.push_back({"first and last", table({33, 20, 19}, [](int i, int j, int k) {
                          return (i == 0 && j == 0 && k == 0) || (i == 32 && j == 19 && k == 18);
                      })});
    shapes.push_back({"plane x", table({40, 17, 23}, [](int i, int, int) { return i == 31; })});
    shapes.push_back({"plane y", table({35, 21, 18}, [](int, int j, int) { return j == 5; })});
    shapes.push_back({"plane z", table({31, 16, 25}, [](int, int, int k) { return k == 24; })});
    shapes.push_back({"two planes, ties between",
                      table({32, 16, 16}, [](int i, int, int k) { return i == 4 || i == 10 || k == 3 || k == 9; })});
    shapes.push_back({"all skin", table({34, 9, 8}, [](int, int, int) { return true; })});
    shapes.push_back(
        {"chequered, all ties", table({36, 12, 11}, [](int i, int j, int k) { return (i + j + k) % 2 == 0; })});
    shapes.push_back({"every third slice and row",
                      table({67, 24, 24}, [](int i, int j, int k) { return k % 3 == 1 && j % 5 == 2 && i % 7 == 3; })});
    shapes.push_back({"row", table({129, 1, 1}, [](int i, int, int) { return i % 40 == 20; })});
    shapes.push_back({"column", table({1, 130, 1}, [](int, int j, int) { return j % 50 == 7; })});
    shapes.push_back({"stack", table({1, 1, 131}, [](int, int, int k) { return k == 3 || k == 90; })});
    shapes.push_back({"shell", table({50, 44, 47}, [](int i, int j, int k) {
                          return std::abs(std::hypot(i - 24.3, j - 22.0, k - 20.5) - 16) < 0.6;
                      })});
    unsigned seed = 1;
    for (const int x : {15, 16, 31, 32, 33, 64, 65})
        for (const double share : {0.0008, 0.02}) {
            SkinLut lut = sparse({x, 19 + static_cast<int>(seed), 41 - static_cast<int>(seed)}, share, seed);
            if (!lut.skin.empty()) shapes.push_back({"sparse", std::move(lut)});
            ++seed;
        }
    return shapes;
}

class NearestTransform : public testing::TestWithParam<VectorPath> {
protected:
    void SetUp() override {
        if (!can_use(GetParam())) GTEST_SKIP() << "this processor does not have these instructions";
    }
};

TEST_P(NearestTransform, PointsEveryVoxelOfSmallTablesToTheFirstOfItsNearest) {
    for (Shape& shape : small_shapes()) {
        point_to_nearest(shape.lut, GetParam());
        const ByTrying trying(shape.lut);
        std::size_t wrong = 0, n = 0;
        for (int k = 0; k < shape.lut.size[2]; ++k)
            for (int j = 0; j < shape.lut.size[1]; ++j)
                for (int i = 0; i < shape.lut.size[0]; ++i)
                    wrong += shape.lut.nearest.at(n++) != trying.nearest(i, j, k);
        EXPECT_EQ(wrong, 0U) << shape.name << ", " << shape.lut.size[0] << " x " << shape.lut.size[1] << " x "
                             << shape.lut.size[2];
        EXPECT_EQ(n, shape.lut.nearest.size());
    }
}

TEST_P(NearestTransform, TablesTooLongForThePackedKeysGetWideOnes) {
    // 1024^3 is the largest cube whose squared distances and slice numbers share 32 bits; one long axis needs 64.
    for (const std::array<int, 3> size :
         {std::array{5, 7, 2100}, {40, 1300, 9}, {9000, 4, 6}, {3, 2050, 3}, {1, 1, 16384}}) {
        SkinLut lut = sparse(size, 0.001, 5);
        lut.skin.insert(lut.skin.begin(), skin_at(0, 0, 0));
        if (lut.skin.size() > 1 && lut.skin[1].voxel == lut.skin[0].voxel) lut.skin.erase(lut.skin.begin());
        point_to_nearest(lut, GetParam());
        const ByTrying trying(lut);
        std::size_t wrong = 0, n = 0;
        for (int k = 0; k < size[2]; ++k)
            for (int j = 0; j < size[1]; ++j)
                for (int i = 0; i < size[0]; ++i) wrong += lut.nearest.at(n++) != trying.nearest(i, j, k);
        EXPECT_EQ(wrong, 0U) << size[0] << " x " << size[1] << " x " << size[2];
    }
}

INSTANTIATE_TEST_SUITE_P(Paths, NearestTransform,
                         testing::Values(VectorPath::plain, VectorPath::avx2, VectorPath::avx512),
                         [](const auto& path) {
                             return path.param == VectorPath::plain  ? "Plain"
                                    : path.param == VectorPath::avx2 ? "Avx2"
                                                                     : "Avx512";
                         });

/// A bumpy closed shell of a head's shape over most of a table.
SkinLut large_shell(std::array<int, 3> size) {
    return table(size, [&](int i, int j, int k) {
        const double x = (i - 0.5 * size[0]) / (0.33 * size[0]), y = (j - 0.47 * size[1]) / (0.36 * size[1]),
                     z = (k - 0.5 * size[2]) / (0.34 * size[2]);
        const double r = x * x + y * y + z * z;
        if (r < 0.7 || r > 1.4) return false;
        return std::abs(std::sqrt(r) + 0.04 * std::sin(9 * x) * std::cos(7 * y + z) - 1) < 1.8 / size[0];
    });
}

TEST(NearestTransformLarge, AHundredThousandVoxelsPointToTheFirstOfTheirNearestAndAllPathsAgree) {
    SkinLut lut = large_shell({251, 230, 203});
    ASSERT_GT(lut.skin.size(), 50000U);
    point_to_nearest(lut, VectorPath::plain);
    const LargeArray<std::uint32_t> plain = lut.nearest;
    for (const VectorPath path : {VectorPath::avx2, VectorPath::avx512, VectorPath::best}) {
        if (!can_use(path)) continue;
        point_to_nearest(lut, path);
        EXPECT_EQ(lut.nearest, plain);
    }
    // Every skin voxel that could be as near lies within the cube of the distance found: rows are looked up, not all
    // tried.
    std::vector<std::uint32_t> row_begin(static_cast<std::size_t>(lut.size[1] * lut.size[2]) + 1, 0);
    for (const auto& s : lut.skin) ++row_begin[static_cast<std::size_t>(s.voxel[2] * lut.size[1] + s.voxel[1]) + 1];
    for (std::size_t r = 1; r < row_begin.size(); ++r) row_begin[r] += row_begin[r - 1];
    std::mt19937 random(11);
    std::size_t wrong = 0;
    for (int n = 0; n < 100000; ++n) {
        int v[3];
        for (std::size_t a = 0; a < 3; ++a) v[a] = std::uniform_int_distribution<int>(0, lut.size[a] - 1)(random);
        const auto squared = [&](std::uint32_t s) {
            int sum = 0;
            for (std::size_t a = 0; a < 3; ++a) sum += (lut.skin[s].voxel[a] - v[a]) * (lut.skin[s].voxel[a] - v[a]);
            return sum;
        };
        const std::uint32_t found =
            lut.nearest[static_cast<std::size_t>((v[2] * lut.size[1] + v[1]) * lut.size[0] + v[0])];
        const int least = squared(found), reach = static_cast<int>(std::sqrt(least));
        bool right = true;
        for (int k = std::max(0, v[2] - reach); k <= std::min(lut.size[2] - 1, v[2] + reach); ++k)
            for (int j = std::max(0, v[1] - reach); j <= std::min(lut.size[1] - 1, v[1] + reach); ++j) {
                if ((k - v[2]) * (k - v[2]) + (j - v[1]) * (j - v[1]) > least) continue;
                const auto row = static_cast<std::size_t>(k * lut.size[1] + j);
                for (std::uint32_t s = row_begin[row]; s < row_begin[row + 1]; ++s)
                    right = right && (squared(s) > least || (squared(s) == least && s >= found));
            }
        wrong += !right;
    }
    EXPECT_EQ(wrong, 0U);
}

TEST(NearestTransformLarge, RefusesASkinThatIsNotInTheOrderOfTheTable) {
    SkinLut lut = sparse({20, 20, 20}, 0.05, 3);
    std::swap(lut.skin[3], lut.skin[9]);
    EXPECT_THROW(point_to_nearest(lut), std::logic_error);
    lut = sparse({20, 20, 20}, 0.05, 3);
    lut.size = {20, 20, 15};
    EXPECT_THROW(point_to_nearest(lut), std::logic_error);
    lut.skin.clear();
    EXPECT_THROW(point_to_nearest(lut), std::logic_error);
}

}  // namespace
}  // namespace planlight::test
