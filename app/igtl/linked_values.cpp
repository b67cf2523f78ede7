#include "app/igtl/linked_values.h"

#include "app/igtl/igtl_messages.h"

namespace planlight {
namespace {

/// In the order in which a client is told.
enum Place : std::size_t { kGate, kMatch, kPose, kLight, kPoses, kLightError, kPoseError };

MessageServer::Message made(std::string bytes) {
    return std::make_shared<const std::string>(std::move(bytes));
}

bool same(const std::optional<RigidTransform>& a, const std::optional<RigidTransform>& b) {
    return a.has_value() == b.has_value() && (!a || a->matrix() == b->matrix());
}

/// T_cur, T_global and all three in one message; `light` is of the moment that was seen.
void set_poses(MessageServer& server, const LinkedValues& now) {
    if (!now.rig_from_patient) {
        for (const Place place : {kPose, kLight, kPoses, kPoseError}) server.set_newest(place, nullptr);
        return;
    }
    std::vector<NamedTransform> poses{{"T_cur", *now.rig_from_patient}};
    server.set_newest(kPose, made(transform_message({"T_cur", now.seen_utc_s}, *now.rig_from_patient)));
    if (now.patient_from_ct) {
        const RigidTransform rig_from_ct = *now.rig_from_patient * *now.patient_from_ct;  // T_global = T_cur T_ini
        server.set_newest(kLight, made(transform_message({"T_global", now.seen_utc_s}, rig_from_ct)));
        poses.insert(poses.begin(), {"T_ini", *now.patient_from_ct});
        poses.push_back({"T_global", rig_from_ct});
    } else {
        server.set_newest(kLight, nullptr);
    }
    server.set_newest(kPoses, made(tracking_message({"Poses", now.seen_utc_s}, poses)));
    server.set_newest(kPoseError,
                      made(lengths_message({"PoseError", now.seen_utc_s}, {now.predicted_error_mm, now.bound_95_mm})));
}

}  // namespace

void set_gate_message(MessageServer& server, const LinkedValues& now, double utc_s) {
    LinkCode code = LinkCode::disabled;
    const char* word = "dark";
    if (now.trust == LightTrust::look) code = LinkCode::not_ready, word = "look";
    if (now.trust == LightTrust::aligned) code = LinkCode::ok, word = "aligned";
    server.set_newest(
        kGate, made(status_message({"Gate", utc_s}, code, static_cast<std::int64_t>(now.trust), word, now.words)));
}

void set_stale_messages(MessageServer& server, double utc_s) {
    set_poses(server, {});
    server.set_newest(kLightError, nullptr);
    server.set_newest(kGate, made(status_message({"Gate", utc_s}, LinkCode::connection_lost, -1, "stale",
                                                 "Nothing is heard from the session: trust no pose.")));
}

void set_messages(MessageServer& server, const LinkedValues& now, const LinkedValues* before) {
    if (!before || now.trust != before->trust || now.words != before->words)
        set_gate_message(server, now, now.said_utc_s);
    if (!before || !same(now.patient_from_ct, before->patient_from_ct))
        server.set_newest(kMatch, now.patient_from_ct
                                      ? made(transform_message({"T_ini", now.matched_utc_s}, *now.patient_from_ct))
                                      : nullptr);
    if (!before || now.seen_utc_s != before->seen_utc_s || !same(now.rig_from_patient, before->rig_from_patient) ||
        !same(now.patient_from_ct, before->patient_from_ct))
        set_poses(server, now);
    if (!before || now.off_mm != before->off_mm || now.sigma_mm != before->sigma_mm)
        server.set_newest(kLightError, now.off_mm ? made(lengths_message({"LightError", now.said_utc_s},
                                                                         {*now.off_mm, now.sigma_mm.value_or(0)}))
                                                  : nullptr);
}

}  // namespace planlight
