//! Voxel grids: file formats, phantoms, conversion to voxel words
