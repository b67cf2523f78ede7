#pragma once

#include <vtkSmartPointer.h>

#include "app/windows/operator_model.h"

class vtkPolyData;

namespace planlight {

/// The skin with normals; lids and cut planes are greyer than skin.
vtkSmartPointer<vtkPolyData> skin_shape(const SceneModel& scene);

/// The scanned points (in rig) with colours; of a large cloud every n-th.
vtkSmartPointer<vtkPolyData> cloud_shape(const PointCloud& cloud, const std::vector<float>* distance_mm,
                                         double largest_mm);

/// The plan's strokes as coloured tubes, thick enough to be seen; all but `bright_item` are dim where there is one (-1:
/// none).
vtkSmartPointer<vtkPolyData> plan_shape(const PlanDrawing& plan, int bright_item = -1);

/// The surfaces with normals, each in its `risk_colour`; large ones coarser.
vtkSmartPointer<vtkPolyData> risk_shape(const std::vector<RiskStructure>& structures);

/// The light as white tubes, thinner than the plan's.
vtkSmartPointer<vtkPolyData> light_shape(const std::vector<LightLine>& light);

/// Black discs on white stickers (grey when not seen), facing away from `middle_in_ct` when they have no normal.
vtkSmartPointer<vtkPolyData> marker_shape(const std::vector<SceneMarker>& markers, const Eigen::Vector3d& middle_in_ct);

}  // namespace planlight
