#include "registration/scan/decode/gray_cells.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "planning_io/types/statistics.h"
#include "registration/scan/decode/smooth_cells.h"

namespace planlight {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

enum class Fate : unsigned char { lit, dark, saturated, uncertain };

/// Twice the difference of a bit to its opposite, grey.
int twice_difference(const GrayFrames& frames, const GrayDirection& d, std::size_t bit, std::size_t pixel) {
    const int seen = d.bits[bit]->pixels[pixel];
    if (!d.inverses.empty()) return 2 * (seen - d.inverses[bit]->pixels[pixel]);
    return 2 * (2 * seen - frames.white->pixels[pixel] - frames.black->pixels[pixel]);
}

double least_difference(const GrayFrames& frames, std::size_t pixel, const GrayCellSettings& settings) {
    const int contrast = frames.white->pixels[pixel] - frames.black->pixels[pixel];
    return std::max(settings.least_difference_grey, settings.least_share * contrast);
}

/// How many of the bits the optics resolve: up to the finest that most lit pixels can decide.
std::size_t useful_bits(const GrayFrames& frames, const GrayDirection& d, const std::vector<Fate>& fate,
                        const GrayCellSettings& settings) {
    std::size_t bits = d.bits.size();
    for (; bits > 0; --bits) {
        std::size_t lit = 0, doubtful = 0;
        for (std::size_t i = 0; i < fate.size(); i += 7) {
            if (fate[i] != Fate::lit) continue;
            ++lit;
            doubtful += std::abs(twice_difference(frames, d, bits - 1, i)) < 2 * least_difference(frames, i, settings);
        }
        if (static_cast<double>(doubtful) <= settings.useless_share * static_cast<double>(lit)) break;
    }
    return bits;
}

int number_of(int gray) {
    for (int shift = 1; shift < 32; shift *= 2) gray ^= gray >> shift;
    return gray;
}

/// The middle of a pixel's cell, projector pixels; between two cells where just the bit of their border is in doubt;
/// NaN where another is.
float cell_of(const GrayFrames& frames, const GrayDirection& d, std::size_t bits, double cell_px, std::size_t pixel,
              const GrayCellSettings& settings) {
    const double least = 2 * least_difference(frames, pixel, settings);
    int gray = 0, doubt = 0;
    for (std::size_t b = 0; b < bits; ++b) {
        const int difference = twice_difference(frames, d, b, pixel), bit = 1 << (bits - 1 - b);
        if (difference > 0) gray |= bit;
        if (std::abs(difference) >= least) continue;
        if (doubt) return kNaN;
        doubt = bit;
    }
    const int number = number_of(gray), other = doubt ? number_of(gray ^ doubt) : number;
    if (std::abs(number - other) > 1) return kNaN;
    const double middle = ((number + other) / 2.0 + 0.5) * cell_px - 0.5 - d.begins_at;
    return middle > -0.5 && middle < d.size - 0.5 ? static_cast<float>(middle) : kNaN;
}

/// Camera pixels a cell, in the middle of the picture's values; 1 where nothing is decoded.
double cell_in_camera(const std::vector<float>& code, int width, int height, double cell_px, bool along_rows) {
    constexpr int kStep = 24;
    std::vector<double> slopes;
    for (int y = kStep; y + kStep < height; y += 9)
        for (int x = kStep; x + kStep < width; x += 9) {
            const auto at = [&](int dx, int dy) {
                return static_cast<double>(code[static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(width) +
                                                static_cast<std::size_t>(x + dx)]);
            };
            const double slope = along_rows ? at(0, kStep) - at(0, -kStep) : at(kStep, 0) - at(-kStep, 0);
            if (std::abs(slope) > 0) slopes.push_back(std::abs(slope) / (2 * kStep));  // NaN is not greater
        }
    if (slopes.empty()) return 1;
    return cell_px / std::max(median(slopes), 1e-3);
}

struct Direction {
    std::vector<float> code;
    double cell_px = 1, sigma_px = 0;
};

Direction read_direction(const GrayFrames& frames, const GrayDirection& d, bool along_rows, std::vector<Fate>& fate,
                         const GrayCellSettings& settings, int& useless) {
    const int width = frames.white->width, height = frames.white->height;
    const std::size_t bits = useful_bits(frames, d, fate, settings);
    useless += static_cast<int>(d.bits.size() - bits);
    Direction read;
    read.cell_px = d.cell_px * std::pow(2.0, static_cast<double>(d.bits.size() - bits));
    read.code.assign(fate.size(), kNaN);
    if (bits == 0) return read;
    std::vector<float> cells(fate.size(), kNaN);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, fate.size(), 4096),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          for (std::size_t i = range.begin(); i < range.end(); ++i)
                              if (fate[i] == Fate::lit) cells[i] = cell_of(frames, d, bits, read.cell_px, i, settings);
                      });
    const double across = cell_in_camera(cells, width, height, read.cell_px, along_rows);
    const int reach = std::clamp(static_cast<int>(std::ceil(1.5 * across)), 1, 12);
    // Of an even spread over a cell, by the cells that take part.
    read.sigma_px = 0.29 * read.cell_px / std::sqrt(std::max(1.0, (2 * reach + 1) / across));
    smooth_cells(cells, width, height, reach, static_cast<float>(read.cell_px), read.code);
    return read;
}

void check_frames(const GrayFrames& frames) {
    if (!frames.white || !frames.black || frames.columns.bits.empty())
        throw std::invalid_argument("decode_gray_cells: white, black or the columns' bits are missing");
    const auto check = [&](const GrayImage* frame) {
        if (frame->width != frames.white->width || frame->height != frames.white->height || frame->empty())
            throw std::invalid_argument("decode_gray_cells: frames of different size");
    };
    check(frames.black);
    for (const GrayDirection* d : {&frames.columns, &frames.rows}) {
        if (d->bits.size() > 15 || (!d->inverses.empty() && d->inverses.size() != d->bits.size()))
            throw std::invalid_argument("decode_gray_cells: more than 15 bits, or not an inverse for each");
        for (const GrayImage* frame : d->bits) check(frame);
        for (const GrayImage* frame : d->inverses) check(frame);
    }
}

}  // namespace

GrayCells decode_gray_cells(const GrayFrames& frames, const GrayCellSettings& settings) {
    check_frames(frames);
    const std::size_t count = frames.white->pixels.size();
    std::vector<Fate> fate(count, Fate::lit);
    for (std::size_t i = 0; i < count; ++i) {
        if (frames.white->pixels[i] >= settings.saturated_at)
            fate[i] = Fate::saturated;
        else if (frames.white->pixels[i] - frames.black->pixels[i] < settings.least_difference_grey)
            fate[i] = Fate::dark;
    }
    GrayCells cells;
    const bool with_rows = !frames.rows.bits.empty();
    const Direction columns = read_direction(frames, frames.columns, false, fate, settings, cells.useless_bits);
    Direction rows;
    if (with_rows) rows = read_direction(frames, frames.rows, true, fate, settings, cells.useless_bits);
    DecodedView& view = cells.view;
    view.width = frames.white->width;
    view.height = frames.white->height;
    view.column.assign(count, kNaN);
    view.sigma_px.assign(count, kNaN);
    if (with_rows) view.row.assign(count, kNaN);
    for (std::size_t i = 0; i < count; ++i) {
        if (fate[i] == Fate::lit && (std::isnan(columns.code[i]) || (with_rows && std::isnan(rows.code[i]))))
            fate[i] = Fate::uncertain;
        view.dark += fate[i] == Fate::dark;
        view.saturated += fate[i] == Fate::saturated;
        view.uncertain += fate[i] == Fate::uncertain;
        if (fate[i] != Fate::lit) continue;
        ++view.decoded;
        view.column[i] = columns.code[i];
        if (with_rows) view.row[i] = rows.code[i];
        view.sigma_px[i] = static_cast<float>(std::max(columns.sigma_px, rows.sigma_px));
    }
    cells.step_px = with_rows ? std::max(columns.cell_px, rows.cell_px) : columns.cell_px;
    return cells;
}

}  // namespace planlight
