#include "app/live/guide_screen.h"

namespace planlight {
namespace {

const char* word_of(PoseFault fault) {
    switch (fault) {
        case PoseFault::none:
            return "HOLD STILL";
        case PoseFault::not_seen:
            return "NO BOARD";
        case PoseFault::one_camera:
        case PoseFault::in_part:
            return "NOT SEEN";
        case PoseFault::too_dark:
            return "TOO DARK";
        case PoseFault::too_bright:
            return "TOO BRIGHT";
        case PoseFault::blurred:
            return "BLURRED";
        case PoseFault::flat_on:
        case PoseFault::alike:
            return "TILT IT";
        case PoseFault::aslant:
            return "LESS TILT";
        case PoseFault::too_near:
            return "FARTHER";
        case PoseFault::too_far:
            return "NEARER";
        case PoseFault::beside_light:
            return "NO LIGHT";
    }
    return "";
}

GuideModel::Cells cells_of(const PoseCoverage& coverage, DeviceName device) {
    const PoseCoverage::Cells& cells = coverage.cells[static_cast<std::size_t>(device)];
    return {PoseCoverage::kAcross, PoseCoverage::kDown, {cells.begin(), cells.end()}};
}

/// The big word with its sentences: what is wrong with a device goes before what is wrong with the pose.
void tell_mood(const GuideState& state, GuideModel& model) {
    model.why = state.advice.why;
    model.what = state.advice.what;
    model.share = 0;
    if (!state.trouble.empty()) {
        model.mood = GuideModel::Mood::wrong;
        model.word = "WAIT";
        model.why = state.trouble;
        model.what = state.trouble_remedy;
    } else if (state.step != GuideState::Step::watching) {
        const bool capturing = state.step == GuideState::Step::capturing;
        model.mood = GuideModel::Mood::busy;
        model.word = capturing ? "CAPTURING" : "LOOKING";
        model.what = capturing ? "Leave the board as it is." : "You may take it on.";
        model.why.clear();
        model.share = state.step_share;
    } else if (!state.given_up_why.empty() && state.advice.fault == PoseFault::none) {
        model.mood = GuideModel::Mood::wrong;
        model.word = "AGAIN";
        model.why = state.given_up_why;
        model.what = state.given_up_what;
    } else if (state.advice.fault == PoseFault::none) {
        model.mood = GuideModel::Mood::hold;
        model.word = word_of(PoseFault::none);
        model.share = state.advice.still_share;
    } else if (state.advice.fault == PoseFault::alike && state.light.mood == GuideLight::Mood::taken) {
        model.mood = GuideModel::Mood::done;
        model.word = "TAKEN";
        model.why = "Next:";
        std::swap(model.why, model.what);
    } else {
        model.mood = GuideModel::Mood::wrong;
        model.word = word_of(state.advice.fault);
    }
}

}  // namespace

GuideModel guide_model_of(const GuideState& state, const std::string& title, const std::string& subtitle) {
    GuideModel model;
    model.title = title;
    model.subtitle = subtitle;
    model.left = {"Left", state.left, state.left_corners.pixels, cells_of(state.coverage, DeviceName::left_camera)};
    model.right = {"Right", state.right, state.right_corners.pixels,
                   cells_of(state.coverage, DeviceName::right_camera)};
    model.projector = cells_of(state.coverage, DeviceName::projector);
    tell_mood(state, model);
    model.tilts = state.coverage.tilts;
    model.by_edge = state.coverage.by_edge;
    model.useful_tilt = state.useful_tilt;
    model.distances_mm = state.coverage.distances_mm;
    if (state.advice.stance) {
        model.tilt_now = state.advice.stance->tilt;
        model.distance_now_mm = state.advice.stance->distance_mm;
    }
    model.poses = state.poses;
    model.least_poses = state.least_poses;
    model.most_poses = state.most_poses;
    model.predicted_mm = state.predicted_mm;
    model.good_enough_mm = state.good_enough_mm;
    model.wanted = state.wanted;
    return model;
}

}  // namespace planlight
