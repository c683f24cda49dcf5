"""Campaigns of rocks on a slope: trials, their records, statistics and files; no FMI."""
