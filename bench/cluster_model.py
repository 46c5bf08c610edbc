"""What view cells would take on a cluster: the model of docs/guide/view_cells.md#many-machines."""


def modelled(cells, cell_s, cores, rate, start_s):
    """(seconds, share of the cores that works): shards as short as the scheduler can hand out, at least 30 s; the last one takes half as long again."""
    shard_s = max(30.0, 3 * cores / rate)
    seconds = cells * cell_s / cores + start_s + 1.5 * shard_s
    return seconds, cells * cell_s / cores / seconds
