//! What a caster on the base plane asks of its geometry.

use crate::TwinError;
use cube3_frame::Geometry;
use cube3_volume::Volume;

/// The geometry is this volume's.
pub(crate) fn check_geometry(volume: &Volume, geometry: &Geometry) -> Result<(), TwinError> {
    let mut axes = geometry.axes.axis;
    axes.sort_unstable();
    let of_volume = if axes == [0, 1, 2] { geometry.axes.permute(volume.dims) } else { volume.dims };
    let depth = geometry.size[2];
    let templates = [&geometry.u, &geometry.v];
    let whole = templates.iter().all(|t| t.columns.len() == depth + 1 && t.weights.len() == depth);
    if axes != [0, 1, 2] || of_volume != geometry.size || !whole {
        return Err(TwinError::Geometry { made: geometry.size, volume: of_volume });
    }
    Ok(())
}
