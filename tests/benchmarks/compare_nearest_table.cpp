// Nearest skin voxel of every voxel of the example patient's table: ours, on each set of instructions, against the
// distance transforms of ITK and VTK. One program, one run, repeats interleaved, so that the ratios hold on a busy
// machine.
//
//   compare_nearest_table [repeats = 3] [sizes = own,256,512] [ours]      ("ours": without the others, for many rounds)
//
// Everyone allocates its result within its time; a round before the first warms the memory. Ratios are to the first
// line. Wall: the least of all rounds (on a busy machine the nearest to a quiet one); processor (all threads together):
// the median.
#include <fmt/format.h>
#include <itkDanielssonDistanceMapImageFilter.h>
#include <itkImage.h>
#include <itkMultiThreaderBase.h>
#include <itkSignedMaurerDistanceMapImageFilter.h>
#include <vtkImageData.h>
#include <vtkImageEuclideanDistance.h>
#include <vtkNew.h>
#include <vtkSmartPointer.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <memory>
#include <random>
#include <sstream>
#include <thread>

#include "planning_io/case/skin_lut_file.h"
#include "planning_io/volume/read_volume.h"
#include "segmentation/build_skin_lut.h"
#include "segmentation/nearest_transform.h"
#include "segmentation/segment_skin.h"
#include "segmentation/signed_distance_grid.h"
#include "segmentation/skin_voxels.h"
#include "tests/benchmarks/time_round.h"
#include "tests/support/test_data.h"

namespace planlight {
namespace {

using ByteImage = itk::Image<unsigned char, 3>;
using FloatImage = itk::Image<float, 3>;

constexpr double kDanielssonMost = 300.0 * 300 * 300;  // voxels; beyond it takes minutes and 4 GiB

std::size_t at(int index) {
    return static_cast<std::size_t>(index);
}

/// The patient's skin in a table of `n` voxels along each side, or of the table's own size for 0.
SkinLut skin_in_table(const TriangleMesh& skin, int n) {
    SkinLut lut = build_skin_lut(skin);
    if (n == 0) return lut;
    const double largest = *std::max_element(lut.size.begin(), lut.size.end()) - 1;
    lut.voxel_mm = largest * lut.voxel_mm / (n - 1);
    lut.size = {n, n, n};
    lut.nearest = {};
    mark_skin_voxels(skin, lut);
    return lut;
}

struct Contestant {
    std::string name, gives;
    std::function<void()> run;
    std::function<double(std::size_t)> squared;  ///< distance it found for a voxel
    std::vector<double> wall_s{}, processor_s{};
    double exact = 0;  ///< share of voxels off the skin

    double wall() const {
        return *std::min_element(wall_s.begin(), wall_s.end());
    }  // others on the machine only add to it
    double processor() const { return middle(processor_s); }

private:
    static double middle(std::vector<double> v) {
        std::sort(v.begin(), v.end());
        return v[(v.size() - 1) / 2];
    }
};

void time(Contestant& one) {
    test::time_round(one.run, one.wall_s, one.processor_s);
}

/// The table, and the same voxels as the peers want them.
struct Scene {
    SkinLut lut;
    ByteImage::Pointer itk_image = ByteImage::New();
    vtkNew<vtkImageData> vtk_image;

    explicit Scene(SkinLut made) : lut(std::move(made)) {
        ByteImage::RegionType region;
        for (unsigned a = 0; a < 3; ++a) region.SetSize(a, at(lut.size[a]));
        itk_image->SetRegions(region);
        itk_image->Allocate(true);
        vtk_image->SetDimensions(lut.size.data());
        vtk_image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
        auto* inverse = static_cast<unsigned char*>(vtk_image->GetScalarPointer());
        std::fill_n(inverse, voxels(), static_cast<unsigned char>(1));
        for (const auto& s : lut.skin) itk_image->GetBufferPointer()[index(s)] = 1, inverse[index(s)] = 0;
    }
    std::size_t voxels() const { return at(lut.size[0]) * at(lut.size[1]) * at(lut.size[2]); }
    std::size_t index(const SkinPoint& s) const {
        return (at(s.voxel[2]) * at(lut.size[1]) + s.voxel[1]) * at(lut.size[0]) + s.voxel[0];
    }
    std::array<int, 3> voxel(std::size_t n) const {
        const std::size_t row = at(lut.size[0]), slab = row * at(lut.size[1]);
        return {static_cast<int>(n % row), static_cast<int>(n % slab / row), static_cast<int>(n / slab)};
    }
    double squared(std::size_t voxel_number, std::uint32_t skin) const {
        const auto v = voxel(voxel_number);
        double sum = 0;
        for (std::size_t a = 0; a < 3; ++a) sum += std::pow(lut.skin[skin].voxel[a] - v[a], 2);
        return sum;
    }
};

std::vector<Contestant> contestants(Scene& scene, bool with_peers) {
    std::vector<Contestant> all;
    const std::pair<VectorPath, const char*> paths[] = {
        {VectorPath::avx512, "ours, AVX-512"}, {VectorPath::avx2, "ours, AVX2"}, {VectorPath::plain, "ours, plain"}};
    for (const auto& [path, name] : paths)
        if (can_use(path))
            all.push_back({name, "voxel", [&scene, path] { point_to_nearest(scene.lut, path); },
                           [&scene](std::size_t n) { return scene.squared(n, scene.lut.nearest[n]); }});
    if (!with_peers) return all;
    using Maurer = itk::SignedMaurerDistanceMapImageFilter<ByteImage, FloatImage>;
    auto maurer = std::make_shared<Maurer::Pointer>();
    all.push_back(
        {"itk::SignedMaurerDistanceMap", "distance",
         [&scene, maurer] {
             *maurer = Maurer::New();
             (*maurer)->SetInput(scene.itk_image);
             (*maurer)->SquaredDistanceOn();
             (*maurer)->UseImageSpacingOff();
             (*maurer)->Update();
         },
         [maurer](std::size_t n) { return static_cast<double>((*maurer)->GetOutput()->GetBufferPointer()[n]); }});
    auto saito = std::make_shared<vtkSmartPointer<vtkImageEuclideanDistance>>();
    all.push_back(
        {"vtkImageEuclideanDistance", "distance",
         [&scene, saito] {
             *saito = vtkSmartPointer<vtkImageEuclideanDistance>::New();
             (*saito)->SetInputData(scene.vtk_image);
             (*saito)->ConsiderAnisotropyOff();
             (*saito)->Update();
         },
         [saito](std::size_t n) { return static_cast<double*>((*saito)->GetOutput()->GetScalarPointer())[n]; }});
    if (static_cast<double>(scene.voxels()) > kDanielssonMost) return all;
    using Danielsson = itk::DanielssonDistanceMapImageFilter<ByteImage, FloatImage>;
    auto danielsson = std::make_shared<Danielsson::Pointer>();
    all.push_back({"itk::DanielssonDistanceMap", "voxel",
                   [&scene, danielsson] {
                       *danielsson = Danielsson::New();
                       (*danielsson)->SetInput(scene.itk_image);
                       (*danielsson)->UseImageSpacingOff();
                       (*danielsson)->Update();
                   },
                   [danielsson](std::size_t n) {
                       const auto& offset = (*danielsson)->GetVectorDistanceMap()->GetBufferPointer()[n];
                       return std::pow(offset[0], 2) + std::pow(offset[1], 2) + std::pow(offset[2], 2);
                   }});
    return all;
}

/// Our pointers against trying every skin voxel, at random voxels; how many are wrong.
int wrong_of_samples(const Scene& scene, int samples) {
    std::mt19937_64 random(1);
    int wrong = 0;
    for (int i = 0; i < samples; ++i) {
        const std::size_t n = random() % scene.voxels();
        double least = INFINITY;
        for (std::uint32_t s = 0; s < scene.lut.skin.size(); ++s) least = std::min(least, scene.squared(n, s));
        wrong += least != scene.squared(n, scene.lut.nearest[n]);
    }
    return wrong;
}

void compare(const TriangleMesh& skin, int n, int repeats, bool with_peers) {
    Scene scene(skin_in_table(skin, n));
    std::vector<Contestant> all = contestants(scene, with_peers);
    for (Contestant& one : all) time(one);  // the first round only warms the memory
    for (Contestant& one : all) one.wall_s.clear(), one.processor_s.clear();
    for (int r = 0; r < repeats; ++r)  // each time another one begins
        for (std::size_t c = 0; c < all.size(); ++c) time(all[(c + static_cast<std::size_t>(r)) % all.size()]);
    std::vector<bool> on_skin(scene.voxels());
    for (const auto& s : scene.lut.skin) on_skin[scene.index(s)] = true;
    for (Contestant& one : all) {
        std::size_t same = 0;
        for (std::size_t v = 0; v < scene.voxels(); ++v)
            same += !on_skin[v] && std::abs(one.squared(v) - scene.squared(v, scene.lut.nearest[v])) < 1e-3;
        one.exact = static_cast<double>(same) / static_cast<double>(scene.voxels() - scene.lut.skin.size());
    }
    const int samples = 1000, wrong = wrong_of_samples(scene, samples);
    fmt::print("\n{} x {} x {} voxels, {} of skin; {} rounds; ours wrong at {} of {} voxels tried by brute force\n",
               scene.lut.size[0], scene.lut.size[1], scene.lut.size[2], scene.lut.skin.size(), repeats, wrong, samples);
    fmt::print("{:30} {:>9} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "", "gives", "wall s", "CPU s", "x wall", "x CPU",
               "exact %");
    for (const Contestant& one : all)
        fmt::print("{:30} {:>9} {:>9.4f} {:>9.4f} {:>9.1f} {:>9.1f} {:>9.3f}\n", one.name, one.gives, one.wall(),
                   one.processor(), one.wall() / all[0].wall(), one.processor() / all[0].processor(), 100 * one.exact);
    if (with_peers && static_cast<double>(scene.voxels()) > kDanielssonMost)
        fmt::print("itk::DanielssonDistanceMap is left out at this size.\n");
}

/// The whole build of the table, by stage.
void tell_stages(const TriangleMesh& skin, int repeats) {
    SkinLut lut;
    const auto stage = [&](const char* name, const std::function<void()>& run) {
        Contestant one{name, "", run, {}};
        run();
        for (int r = 0; r < repeats; ++r) time(one);
        fmt::print("{:30} {:>9} {:>9.4f} {:>9.4f}\n", name, "", one.wall(), one.processor());
    };
    stage("build_skin_lut, whole", [&] { lut = build_skin_lut(skin); });
    stage("  skin voxels", [&] { mark_skin_voxels(skin, lut); });
    stage("  pointers", [&] { point_to_nearest(lut); });
    stage("  distance field", [&] { fill_signed_distance(skin, lut); });
}

/// The preparation before the table, and the table's file: written, loaded with every chunk verified.
void tell_rest(const Volume& volume, const TriangleMesh& skin, int repeats) {
    const auto stage = [&](const std::string& name, const std::function<void()>& run) {
        Contestant one{name, "", run, {}};
        run();
        for (int r = 0; r < repeats; ++r) time(one);
        fmt::print("{:30} {:>9} {:>9.4f} {:>9.4f}\n", name, "", one.wall(), one.processor());
    };
    SkinMask mask;
    stage("segment_skin", [&] { mask = segment_skin(volume); });
    stage("triangulate_skin", [&] { triangulate_skin(volume, mask); });
    const test::TemporaryFolder folder;
    for (const int n : {0, 256, 512}) {
        SkinLut lut = skin_in_table(skin, n);
        point_to_nearest(lut);
        lut.volume_hash = lut.mesh_hash = std::string(32, '0');
        const auto file = folder.path() / "skin.lut";
        const std::string size = n == 0 ? "own size" : fmt::format("{}^3", n);
        stage("skin.lut written, " + size, [&] { write_skin_lut(lut, file); });
        stage("skin.lut loaded, " + size, [&] { read_skin_lut(file); });
        fmt::print("{:30} {:>9} {:>9.1f} MB\n", "  its file", "",
                   static_cast<double>(std::filesystem::file_size(file)) / 1e6);
    }
}

}  // namespace
}  // namespace planlight

int main(int count, char** words) {
    using namespace planlight;
    const auto patient = test::example_patient();
    if (!patient) return fmt::print("Debian's invesalius-examples is not installed.\n"), 1;
    const int repeats = count > 1 ? std::max(1, std::atoi(words[1])) : 3;
    itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(std::thread::hardware_concurrency());
    const Volume volume = read_volume(*patient);
    const TriangleMesh skin = triangulate_skin(volume, segment_skin(volume));
    fmt::print("example patient: {} triangles; {} processors\n", skin.triangles.size(),
               std::thread::hardware_concurrency());
    tell_stages(skin, repeats);
    tell_rest(volume, skin, repeats);
    std::istringstream sizes(count > 2 ? words[2] : "own,256,512");
    const bool with_peers = !(count > 3 && std::string(words[3]) == "ours");
    for (std::string size; std::getline(sizes, size, ',');)
        compare(skin, size == "own" ? 0 : std::atoi(size.c_str()), repeats, with_peers);
    return 0;
}
