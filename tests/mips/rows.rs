//! Levels while rows are read and written: the bytes of maps in memory, whatever the bands and their order.
