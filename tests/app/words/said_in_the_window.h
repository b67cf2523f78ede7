#pragma once

#include <set>
#include <string>

// Which sources speak to a person at the window, and which of their sentences never stand there.
namespace planlight::test {

/// Sources whose sentences come into the window.
inline constexpr const char* kSaying[] = {
    "app/windows/banner_panel.cpp",
    "app/windows/camera_page.cpp",
    "app/windows/camera_page_figures.cpp",
    "app/windows/camera_page_panels.cpp",
    "app/windows/camera_panel.cpp",
    "app/windows/doctor_page_lines.cpp",
    "app/windows/doctor_page_panels.cpp",
    "app/windows/evidence_page.cpp",
    "app/windows/guide_panels.cpp",
    "app/windows/guide_window.cpp",
    "app/windows/header_panel.cpp",
    "app/windows/landmark_panel.cpp",
    "app/windows/middle_view.cpp",
    "app/windows/operator_window.cpp",
    "app/windows/review_panels.cpp",
    "app/windows/review_window.cpp",
    "app/windows/scene_overlay.cpp",
    "app/windows/table_panel.cpp",
    "app/doctor/doctor_screen.cpp",
    "app/doctor/examine_room.cpp",
    "app/doctor/judge_room.cpp",
    "app/live/camera_screen.cpp",
    "app/live/guide_screen.cpp",
    "app/live/guided_calibration.cpp",
    "app/live/live_session.cpp",
    "app/live/live_session_run.cpp",
    "app/live/following_status.cpp",
    "app/live/live_session_following.cpp",
    "app/live/live_session_steps.cpp",
    "app/live/skin_check_schedule.cpp",
    "app/live/resume_steps.cpp",
    "app/live/session_states.cpp",
    "app/live/silent_session.cpp",
    "app/live/live_window.cpp",
    "app/live/not_kept.cpp",
    "app/live/projector_watch.cpp",
    "app/live/replay_view.cpp",
    "app/live/review_desk.cpp",
    "app/live/shown_replay.cpp",
    "app/live/real_room.cpp",
    "app/live/room_cameras.cpp",
    "app/live/projector_keeper.cpp",
    "app/recording/recording_time_line.cpp",
    "app/case_model.cpp",
    "app/check_skin.cpp",
    "app/resume_match.cpp",
    "app/session.cpp",
    "app/update_latency.cpp",
    "app/verify_landmarks.cpp",
    "projection/check_items.cpp",
    "projection/light_gate.cpp",
    "projection/light_cause_words.cpp",
    "projection/overlay_loop.cpp",
    "projection/render_words.cpp",
    "projection/skin_now.cpp",
    "projection/monitor/projector_process.cpp",
    "projection/monitor/light_mailbox.cpp",
    "registration/calibration/check_drift.cpp",
    "registration/calibration/pose_guide.cpp",
    "registration/calibration/pose_wanted.cpp",
    "registration/matching/judge_match.cpp",
    "registration/matching/match_evidence.cpp",
    "registration/matching/point_pairs.cpp",
    "registration/matching/register_patient.cpp",
    "registration/matching/register_with_landmarks.cpp",
    "registration/tracking/fit_pose.cpp",
    "registration/tracking/match_constellation.cpp",
    "registration/tracking/track_patient.cpp",
    "registration/scan/capture_scan.cpp",
    "registration/scan/scan_from_capture.cpp",
    "registration/scan/check/check_sequence.cpp",
    "registration/scan/decode/merge_exposures.cpp",
    "registration/scan/triangulate/find_rig_state.cpp",
    "registration/devices/paired_cameras.cpp",
    "registration/devices/genicam_camera.cpp",
    "registration/devices/genicam_automatics.cpp",
    "registration/devices/gstreamer_camera.cpp",
    "registration/devices/recorded_camera.cpp",
    "registration/devices/recorded_projector.cpp",
    "segmentation/doubt_head.cpp",
    "segmentation/doubt_surface.cpp",
    "segmentation/doubt_series.cpp",
    "segmentation/skin_doubts.h",
};

/// What these sources say is shown in the window, but for the texts that stand here with the reason.
inline const std::set<std::string> kNotShown{
    "evidence page", "landmark skin", "landmark scan",                   // names of places in the window
    "light item", "hide item", "show item",                              // what a recording calls a press
    "Leave it as it is.",                                                // on the terminal
    "time line",                                                         // name of a place in the window
    "does not say whose it is", "There is nothing in it to look at.",    // on the terminal, when the window is closed
    "holds an event that cannot be understood", "Copy the file again.",  // the same
    "osteotomy line", "cut plane",                                       // in the place of a name
    // In the light of the projector, and names of faults on the terminal.
    "BOARD HERE", "INTO THE LIGHT", "MORE INTO THE PICTURE", "{} CAMERA BLIND", "{} EDGE NEARER",
    "as a pose that is there", "outside the projector's light", "seen in part only", "too near", "Not found",
    "Checking the skin", "Looking again",  // names of states, for the guide
    "Only one",                            // begins a sentence
    "Show landmarks\"", "cameras moved", "lens changed", "distortion wrong",
    "cannot tell",  // verdicts, as files and the terminal name them
    // Said on the terminal, before there is a session.
    "the projector on {} is not the one that was measured on {}: its {} is {}, was {}",
    "Connect that projector, set its resolution, or measure this one with `planlight projector`.",
    // A pipeline.
    " ! videoconvert ! video/x-raw,format=GRAY8 ! appsink name=planlight sync=false max-buffers=2 drop=true",
    // What a camera of a room file does not take: the names of its standard, in a place of a name.
    "a gain of {}", "a question for its exposure", "a question for its region", "an exposure of {} ms",
    "continuous acquisition", "the exposure that it had, {:.2f} ms", "the gain that it had, {:.1f}",
    "the pixel format ", "the region {} {} {} {}", "the trigger ", "{} frames a second", "{}exposure_ms{}",
    "{}frames_hz{}",
    // Why a volume is refused, before there is a case.
    "What was found is no human head: the largest ball within it has a radius of {:.0f} mm (a newborn's head holds one "
    "of 45 mm)",
    "What was found is no head: the largest ball within it has a radius of {:.0f} mm (a head holds one of 60 to 85 mm)",
    "There is no scalp: only under {:.0f} % of the surface of the vault lies a layer of bone with soft tissue over it "
    "(on heads 60 to 100 %); this is a stripped brain, a phantom or no head",
    "There is no soft tissue over the bone ({:.1f} mm): this is a dry skull or a phantom",
    "Give the CT or MR series of the whole head as the scanner made it; for a phantom or a dry skull use `planlight "
    "prepare --phantom`.",
    "Whether scalp lies over bone cannot be told: {:.0f} % of the head show exactly the greatest value, as where a CT "
    "was "
    "saved through a window for pictures, which makes bone and all that is brighter one grey",
    "Give the series in HU: its DICOM files, or converted without a window.",
    "none of the outline stays where it is, or no air is left round it, when the threshold is taken at 0.7 times what "
    "was "
    "found ({})",
    "The skin cannot be told from what surrounds it: ", "{}the {} ({:.0f} square cm)"};

}  // namespace planlight::test
