//! What a caster on the base plane asks of its geometry.

use crate::TwinError;
use cube3_frame::Geometry;
use cube3_machine::GradientMethod;
use cube3_volume::Volume;

/// The geometry is this volume's.
pub(crate) fn check_geometry(volume: &Volume, geometry: &Geometry) -> Result<(), TwinError> {
    let mut axes = geometry.axes.axis;
    axes.sort_unstable();
    let of_volume = if axes == [0, 1, 2] { geometry.axes.permute(volume.dims) } else { volume.dims };
    let depth = geometry.size[2];
    let whole = match &geometry.perspective {
        Some(pass) => [&pass.u, &pass.v].iter().all(|fan| fan.count() > 0 && fan.slopes.len() == fan.count()),
        None => [&geometry.u, &geometry.v].iter().all(|t| t.columns.len() == depth + 1 && t.weights.len() == depth),
    };
    if axes != [0, 1, 2] || of_volume != geometry.size || !whole {
        return Err(TwinError::Geometry { made: geometry.size, volume: of_volume });
    }
    Ok(())
}

/// The estimator can take the rays as they are.
pub(crate) fn check_estimator(geometry: &Geometry, method: GradientMethod) -> Result<(), TwinError> {
    let row = method.row();
    if geometry.perspective.is_some() && row.needs_parallel_rays() {
        return Err(TwinError::Estimator { name: row.name });
    }
    Ok(())
}
