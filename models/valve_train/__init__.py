"""Cam, camshaft, valve and spring (Kushwaha, Rahnejat and Jin 2000; Qin and Zuo 2000)."""
