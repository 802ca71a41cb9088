#!/usr/bin/env python3
# SPDX-FileCopyrightText: The calibrd authors
# SPDX-License-Identifier: Apache-2.0
"""observing.py finds what it is to find."""
import unittest

from observing import alerts, faults_of, unknown_jobs

KNOWN = {"calibrd_pose_valid": {"sensor"}, "calibrd_http_request_duration_seconds_bucket": {"route"}}


class Observing(unittest.TestCase):
    def test_what_is_there_is_no_fault(self):
        self.assertEqual(faults_of('calibrd_pose_valid{sensor="a", instance=~"b"} == 0', KNOWN), [])

    def test_a_metric_that_is_not_there(self):
        self.assertEqual(faults_of("rate(calibrd_pose_vaild[1m])", KNOWN), ["there is no metric calibrd_pose_vaild"])

    def test_a_histogram_is_asked_for_by_its_parts(self):
        self.assertEqual(len(faults_of("calibrd_http_request_duration_seconds", KNOWN)), 1)
        self.assertEqual(faults_of('calibrd_http_request_duration_seconds_bucket{le="1"}', KNOWN), [])

    def test_a_label_that_is_not_there(self):
        self.assertEqual(faults_of('calibrd_pose_valid{name="a"}', KNOWN), ["calibrd_pose_valid has no label name"])

    def test_a_job_that_nothing_scrapes(self):
        self.assertEqual(unknown_jobs('up{job="calibrd"} == 0', ["calibrd"]), [])
        self.assertEqual(unknown_jobs('up{job="cells"} == 0', ["calibrd"]), ["nothing scrapes a job cells"])

    def test_rules_are_read_with_their_comments(self):
        self.assertEqual(alerts("  - alert: A   # why\n    expr: x == 0\n"), [("A", "x == 0")])


if __name__ == "__main__":
    unittest.main()
