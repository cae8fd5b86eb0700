//! What a header says, and the volume behind it.

use crate::layout::Layout;
use crate::parts::Data;
use crate::place::Place;
use crate::volume::check_grid;
use crate::world::Placed;
use crate::{FileFormat, FileInfo, ReadOptions, Volume, VolumeError};

/// What a header says, all formats alike.
pub(crate) struct Described<'a> {
    pub layout: Layout,
    pub placed: Placed,
    pub data: Data<'a>,
    pub remarks: Vec<String>,
}

impl Described<'_> {
    pub fn info(self, format: FileFormat, options: &ReadOptions, place: &Place) -> Result<FileInfo, VolumeError> {
        let Described { layout, placed, remarks, .. } = self;
        check_grid(layout.dims, placed.spacing, placed.origin).map_err(|e| place.grid(e))?;
        let order = placed.order(options.ordering);
        let (spacing, origin, world) = placed.grid(layout.dims, order);
        Ok(FileInfo {
            format,
            dims: order.turn(layout.dims),
            stored_dims: layout.dims,
            spacing,
            origin,
            world,
            sample_type: layout.kept(),
            volumes: usize::try_from(layout.series.count()).unwrap_or(usize::MAX),
            remarks,
        })
    }

    pub fn read(self, options: &ReadOptions, place: &Place) -> Result<Volume, VolumeError> {
        let Described { layout, placed, data, .. } = self;
        check_grid(layout.dims, placed.spacing, placed.origin).map_err(|e| place.grid(e))?;
        let order = placed.order(options.ordering);
        let (spacing, origin, world) = placed.grid(layout.dims, order);
        let samples = layout.read(data, order, options, place)?;
        Volume::new(order.turn(layout.dims), spacing, samples)?.with_world(origin, world)
    }
}
