#include "tests/registration/opencv_pixel.h"

#include <opencv2/calib3d.hpp>

namespace planlight::test {

Eigen::Vector2d opencv_pixel(const CameraModel& d, const Eigen::Vector3d& p_in_rig) {
    const Eigen::Vector3d p = d.device_from_rig * p_in_rig;
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(std::vector<cv::Point3d>{{p.x(), p.y(), p.z()}}, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0),
                      cv::Matx33d(d.focal_x, 0, d.centre_x, 0, d.focal_y, d.centre_y, 0, 0, 1),
                      std::vector<double>{d.k1, d.k2, d.p1, d.p2, d.k3}, pixels);
    return {pixels[0].x, pixels[0].y};
}

}  // namespace planlight::test
