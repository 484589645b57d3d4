(** * Lemma 1: bounds on omega_d and omega_d'

    The paper's Lemma 1 as controller-core/src/certificate/printed.rs computes
    it, from x_f(0) = 0. u is the acceleration command, m/s^2; nu the heading, a
    horizontal unit vector; omega_d, rad/s, and omega_d', rad/s^2, are those of
    [DesiredFrame], which proves that they turn R_d and that one is the other's
    derivative: their formulas are no hypotheses. *)

From Coq Require Import Reals Lra List.
From Coquelicot Require Import Coquelicot.
From SaturatedHybrid Require Import Space Direction DesiredFrame Adjoint Reachable.
Open Scope R_scope.

(** ** The table of printed.rs, from U_u' and U_u'' on *)

Section Bounds.

(** U_u', U_u'', z = g - M_p - K_a3, h = sqrt(2) M_p + K_a12, K_nu', K_nu''. *)
Variables (jerk snap vertical horizontal heading_rate heading_second : R).

(** L. *)
Definition projection : R := vertical / sqrt (vertical * vertical + horizontal * horizontal).
(** U_rho', U_rho'', U_upsilon', U_upsilon''. *)
Definition rho_1_bound : R := jerk / vertical.
Definition rho_2_bound : R := snap / vertical + 3 * (rho_1_bound * rho_1_bound).
Definition upsilon_1_bound : R := (rho_1_bound + heading_rate) / projection.
Definition upsilon_2_bound : R :=
  (rho_2_bound + heading_second + 2 * rho_1_bound * heading_rate) / projection
  + 3 * (upsilon_1_bound * upsilon_1_bound).
(** U_omega, U_omega'. *)
Definition omega_bound : R := sqrt (rho_1_bound * rho_1_bound + upsilon_1_bound * upsilon_1_bound).
Definition omega_1_bound : R :=
  rho_1_bound * upsilon_1_bound + sqrt (rho_2_bound * rho_2_bound + upsilon_2_bound * upsilon_2_bound).

(** A command and a heading that move, at the time t. *)
Variables (u u_1 nu nu_1 : R -> space) (t : R) (u_2 nu_2 : space).
Hypothesis u_moves : moves u t (u_1 t).
Hypothesis u_1_moves : moves u_1 t u_2.
Hypothesis nu_moves : moves nu t (nu_1 t).
Hypothesis nu_1_moves : moves nu_1 t nu_2.
Hypothesis heading : x (nu t) * x (nu t) + y (nu t) * y (nu t) = 1.
Hypothesis vertical_positive : 0 < vertical.
Hypothesis upwards : vertical <= z (u t).
Hypothesis sideways_level : x (u t) * x (u t) + y (u t) * y (u t) <= horizontal * horizontal.
Hypothesis jerk_level : length (u_1 t) <= jerk.
Hypothesis snap_level : length u_2 <= snap.
Hypothesis heading_rate_level : length (nu_1 t) <= heading_rate.
Hypothesis heading_second_level : length nu_2 <= heading_second.

Lemma projection_positive : 0 < projection.
Proof.
  unfold projection. pose proof (squared horizontal).
  assert (0 < vertical * vertical) by (now apply Rmult_lt_0_compat).
  apply Rdiv_lt_0_compat; [exact vertical_positive | apply sqrt_lt_R0; lra].
Qed.

(** L is least where the vertical part is least and the horizontal greatest. *)
Lemma projection_below : projection <= z (u t) / length (u t).
Proof.
  assert (Hu : 0 < length (u t)) by (apply u_length; lra).
  pose proof (length_squared (u t)) as Hn.
  pose proof (squared horizontal) as Hh.
  assert (Hvv : 0 < vertical * vertical) by (now apply Rmult_lt_0_compat).
  unfold projection. set (r := sqrt (vertical * vertical + horizontal * horizontal)).
  assert (Hr : 0 < r) by (apply sqrt_lt_R0; lra).
  assert (Hrr : r * r = vertical * vertical + horizontal * horizontal) by (apply sqrt_def; lra).
  apply Rmult_le_reg_r with (r * length (u t)); [now apply Rmult_lt_0_compat|].
  replace (vertical / r * (r * length (u t))) with (vertical * length (u t)) by (field; lra).
  replace (z (u t) / length (u t) * (r * length (u t))) with (z (u t) * r) by (field; lra).
  apply below_by_squares; [apply Rmult_le_pos; lra|].
  replace (vertical * length (u t) * (vertical * length (u t)))
    with (vertical * vertical * (length (u t) * length (u t))) by ring.
  replace (z (u t) * r * (z (u t) * r)) with (z (u t) * z (u t) * (r * r)) by ring.
  rewrite Hn, Hrr.
  assert (Hzz : vertical * vertical <= z (u t) * z (u t)) by (apply squares_below; lra).
  assert (Hx : vertical * vertical * (x (u t) * x (u t) + y (u t) * y (u t))
    <= z (u t) * z (u t) * (horizontal * horizontal)).
  { apply Rmult_le_compat; try lra. pose proof (squared (x (u t))). pose proof (squared (y (u t))). lra. }
  components. lra.
Qed.

Lemma length_sideways : forall v, length (sideways v) <= length v.
Proof.
  intros v. apply length_below; [apply length_nonneg|]. rewrite length_squared.
  unfold sideways. pose proof (squared (z v)). components. lra.
Qed.

(** U_rho' and U_rho''. *)
Lemma rho_turns_within :
  length (rho_1 u u_1 t) <= rho_1_bound /\ length (rho_2 u u_1 t u_2) <= rho_2_bound.
Proof.
  assert (Hu : vertical <= length (u t)).
  { apply Rle_trans with (z (u t)); [exact upwards|]. apply below_by_squares; [apply length_nonneg|].
    rewrite length_squared. pose proof (squared (x (u t))). pose proof (squared (y (u t))). components. lra. }
  apply direction_turns_within; try assumption. lra.
Qed.

(** U_upsilon' and U_upsilon''. *)
Lemma upsilon_turns_within :
  length (upsilon_1 u u_1 nu nu_1 t) <= upsilon_1_bound /\
  length (upsilon_2 u u_1 nu nu_1 t u_2 nu_2) <= upsilon_2_bound.
Proof.
  destruct rho_turns_within as (H1 & H2).
  assert (Hu : 0 < length (u t)) by (apply u_length; lra).
  assert (Hrho : length (rho u t) = 1) by (now apply direction_length).
  assert (Hnu : length (sideways (nu t)) = 1).
  { unfold length. replace (square (sideways (nu t))) with 1; [apply sqrt_1|].
    rewrite <- heading. unfold sideways. components. ring. }
  pose proof (length_sideways (nu_1 t)) as Hn1. pose proof (length_sideways nu_2) as Hn2.
  assert (Hpos : forall v w, 0 <= length v * length w).
  { intros v w. apply Rmult_le_pos; apply length_nonneg. }
  unfold upsilon_1, upsilon_2, upsilon_1_bound, upsilon_2_bound.
  apply direction_turns_within.
  - apply varpi_positive; [lra | exact heading].
  - exact projection_positive.
  - eapply Rle_trans; [apply projection_below|]. apply varpi_length; [lra | exact heading].
  - unfold varpi_1. eapply Rle_trans; [apply triangle|].
    pose proof (length_cross (sideways (nu_1 t)) (rho u t)) as C1.
    pose proof (length_cross (sideways (nu t)) (rho_1 u u_1 t)) as C2.
    rewrite Hrho in C1. rewrite Hnu in C2. lra.
  - unfold varpi_2.
    pose proof (length_cross (sideways nu_2) (rho u t)) as C1.
    pose proof (length_cross (sideways (nu_1 t)) (rho_1 u u_1 t)) as C2.
    pose proof (length_cross (sideways (nu t)) (rho_2 u u_1 t u_2)) as C3.
    rewrite Hrho in C1. rewrite Hnu in C3.
    assert (C4 : length (sideways (nu_1 t)) * length (rho_1 u u_1 t) <= heading_rate * rho_1_bound).
    { apply Rmult_le_compat; try apply length_nonneg; lra. }
    eapply Rle_trans; [apply triangle|].
    pose proof (triangle (cross (sideways nu_2) (rho u t)) (cross (sideways (nu_1 t)) (rho_1 u u_1 t))).
    pose proof (triangle (cross (sideways (nu_1 t)) (rho_1 u u_1 t)) (cross (sideways (nu t)) (rho_2 u u_1 t u_2))).
    lra.
Qed.

(** |omega_d| <= U_omega, |omega_d'| <= U_omega'. *)
Theorem desired_rates_bounded :
  length (omega u u_1 nu nu_1 t) <= omega_bound /\
  length (omega_1 u u_1 nu nu_1 t u_2 nu_2) <= omega_1_bound.
Proof.
  destruct rho_turns_within as (R1 & R2). destruct upsilon_turns_within as (U1 & U2).
  assert (Hup : 0 < z (u t)) by lra.
  destruct (frame_at_t u u_1 nu nu_1 t Hup heading) as (F1 & F2 & F3 & F4 & F5 & F6).
  destruct (turning_squares _ _ _ _ F1 F2 F3 F4 F5 F6) as (S1 & S2).
  fold (omega u u_1 nu nu_1 t) in S1, S2.
  set (w := omega u u_1 nu nu_1 t) in *.
  pose proof (square_below _ _ R1) as R1s. pose proof (square_below _ _ R2) as R2s.
  pose proof (square_below _ _ U1) as U1s. pose proof (square_below _ _ U2) as U2s.
  split.
  - unfold omega_bound. apply sqrt_le_1_alt. pose proof (squared (y w)). unfold square at 1. unfold dot. lra.
  - unfold omega_1, omega_1_bound. fold w. eapply Rle_trans; [apply triangle|]. apply Rplus_le_compat.
    + assert (Hr : 0 <= rho_1_bound) by (eapply Rle_trans; [apply length_nonneg | exact R1]).
      assert (Hu : 0 <= upsilon_1_bound) by (eapply Rle_trans; [apply length_nonneg | exact U1]).
      apply length_below; [now apply Rmult_le_pos|].
      replace (rho_1_bound * upsilon_1_bound * (rho_1_bound * upsilon_1_bound))
        with ((rho_1_bound * rho_1_bound) * (upsilon_1_bound * upsilon_1_bound)) by ring.
      apply Rle_trans with ((x w * x w + y w * y w) * (y w * y w + z w * z w)).
      * unfold products. pose proof (squared (y w * y w)). components. lra.
      * rewrite S1, S2. apply Rmult_le_compat; try apply square_nonneg; assumption.
    + apply sqrt_le_1_alt. pose proof (turning_of_seconds _ _ F1 F2 F3
        (rho_2 u u_1 t u_2) (upsilon_2 u u_1 nu nu_1 t u_2 nu_2)). lra.
Qed.

End Bounds.

(** ** The whole of it, with the filters

    u = u_f + a + g e3: u_f and u_s of three axes filtered from an input in the
    box of M, flown from rest until t; a the reference's acceleration. The input
    may have jumped before t. *)

Section Flown.

Variables (k_f k_s M g K_12 K_3 K_j K_s K_nu_1 K_nu_2 : R).
Hypothesis bandwidths : 0 < k_f /\ 0 < k_s.
Hypothesis levels : 0 <= M /\ 0 <= K_12.
Hypothesis hover_is_left : M + K_3 < g.

(** U_u' and U_u'' of printed.rs; z and h. *)
Definition jerk_bound : R := 2 * sqrt 3 * k_f * half_l1_norm k_f k_s * M + K_j.
Definition snap_bound : R := 2 * sqrt 3 * k_f * M * (k_f * half_l1_norm k_f k_s + k_s) + K_s.
Definition vertical_least : R := g - M - K_3.
Definition horizontal_greatest : R := sqrt 2 * M + K_12.

Variables (u_f u_s ubar a a_1 nu nu_1 : R -> space) (jumps : list R) (t : R) (a_2 nu_2 : space).
Hypothesis flown_x : flight k_f k_s M (fun s => x (u_f s)) (fun s => x (u_s s)) (fun s => x (ubar s)) jumps t.
Hypothesis flown_y : flight k_f k_s M (fun s => y (u_f s)) (fun s => y (u_s s)) (fun s => y (ubar s)) jumps t.
Hypothesis flown_z : flight k_f k_s M (fun s => z (u_f s)) (fun s => z (u_s s)) (fun s => z (ubar s)) jumps t.
Hypothesis input_x : - M <= x (ubar t) <= M.
Hypothesis input_y : - M <= y (ubar t) <= M.
Hypothesis input_z : - M <= z (ubar t) <= M.
Hypothesis u_f_moves : moves u_f t (scaled (- k_f) (sub (u_f t) (u_s t))).
Hypothesis u_s_moves : moves u_s t (scaled (- k_s) (sub (u_s t) (ubar t))).
Hypothesis a_moves : moves a t (a_1 t).
Hypothesis a_1_moves : moves a_1 t a_2.
Hypothesis nu_moves : moves nu t (nu_1 t).
Hypothesis nu_1_moves : moves nu_1 t nu_2.
Hypothesis a_across : x (a t) * x (a t) + y (a t) * y (a t) <= K_12 * K_12.
Hypothesis a_vertical : - K_3 <= z (a t) <= K_3.
Hypothesis jerk_level : length (a_1 t) <= K_j.
Hypothesis snap_level : length a_2 <= K_s.
Hypothesis heading : x (nu t) * x (nu t) + y (nu t) * y (nu t) = 1.
Hypothesis heading_rate_level : length (nu_1 t) <= K_nu_1.
Hypothesis heading_second_level : length nu_2 <= K_nu_2.

Definition command (s : R) : space := add (u_f s) (add (a s) {| x := 0; y := 0; z := g |}).
Definition command_1 (s : R) : space := add (scaled (- k_f) (sub (u_f s) (u_s s))) (a_1 s).
Definition command_2 : space :=
  add (scaled k_f (sub (scaled k_f (sub (u_f t) (u_s t))) (scaled k_s (sub (u_s t) (ubar t))))) a_2.

Lemma command_moves : moves command t (command_1 t) /\ moves command_1 t command_2.
Proof.
  split.
  - assert (Hg : moves (fun _ => {| x := 0; y := 0; z := g |}) t {| x := 0; y := 0; z := 0 |}).
    { exact (conj (derive_constant 0 t) (conj (derive_constant 0 t) (derive_constant g t))). }
    eapply moves_as; [exact (moves_add _ _ _ _ _ u_f_moves (moves_add _ _ _ _ _ a_moves Hg))|].
    unfold command_1. apply same; components; ring.
  - eapply moves_as.
    + exact (moves_add _ _ _ _ _ (moves_scaled _ _ _ _ _ (derive_constant (- k_f) t)
        (moves_sub _ _ _ _ _ u_f_moves u_s_moves)) a_1_moves).
    + unfold command_2. apply same; components; ring.
Qed.

Lemma three_axes : forall v b, 0 <= b -> Rabs (x v) <= b -> Rabs (y v) <= b -> Rabs (z v) <= b ->
  length v <= sqrt 3 * b.
Proof.
  intros v b Hb Hx Hy Hz. assert (H3 : sqrt 3 * sqrt 3 = 3) by (apply sqrt_def; lra).
  apply length_below; [apply Rmult_le_pos; [apply sqrt_pos | exact Hb]|].
  replace (sqrt 3 * b * (sqrt 3 * b)) with (sqrt 3 * sqrt 3 * (b * b)) by ring. rewrite H3.
  assert (Hsq : forall c, Rabs c <= b -> c * c <= b * b).
  { intros c Hc. replace (c * c) with (Rabs c * Rabs c) by (rewrite <- Rabs_mult; apply Rabs_pos_eq, squared).
    apply squares_below; [apply Rabs_pos | exact Hc]. }
  pose proof (Hsq _ Hx). pose proof (Hsq _ Hy). pose proof (Hsq _ Hz). components. lra.
Qed.

Lemma command_levels :
  vertical_least <= z (command t) /\
  x (command t) * x (command t) + y (command t) * y (command t) <= horizontal_greatest * horizontal_greatest /\
  length (command_1 t) <= jerk_bound /\ length command_2 <= snap_bound.
Proof.
  destruct levels as (HM & HK). pose proof (half_l1_norm_range k_f k_s bandwidths) as Hl.
  pose proof (filtered_within_level _ _ _ bandwidths HM _ _ _ _ _ flown_x) as Bx.
  pose proof (filtered_within_level _ _ _ bandwidths HM _ _ _ _ _ flown_y) as By.
  pose proof (filtered_within_level _ _ _ bandwidths HM _ _ _ _ _ flown_z) as Bz. cbv beta in Bx, By, Bz.
  split; [|split; [|split]].
  - unfold command, vertical_least. components. pose proof (Rcomplements.Rabs_le_between (z (u_f t)) M). lra.
  - assert (H2 : sqrt 2 * sqrt 2 = 2) by (apply sqrt_def; lra).
    assert (H : length (add {| x := x (u_f t); y := y (u_f t); z := 0 |} {| x := x (a t); y := y (a t); z := 0 |})
      <= horizontal_greatest).
    { eapply Rle_trans; [apply triangle|]. unfold horizontal_greatest. apply Rplus_le_compat.
      - apply length_below; [apply Rmult_le_pos; [apply sqrt_pos | exact HM]|].
        replace (sqrt 2 * M * (sqrt 2 * M)) with (sqrt 2 * sqrt 2 * (M * M)) by ring. rewrite H2.
        assert (Hsq : forall c, Rabs c <= M -> c * c <= M * M).
        { intros c Hc. replace (c * c) with (Rabs c * Rabs c) by (rewrite <- Rabs_mult; apply Rabs_pos_eq, squared).
          apply squares_below; [apply Rabs_pos | exact Hc]. }
        pose proof (Hsq _ Bx). pose proof (Hsq _ By). components. lra.
      - apply length_below; [exact HK|]. components. lra. }
    apply square_below in H. unfold command. components. lra.
  - unfold command_1, jerk_bound. eapply Rle_trans; [apply triangle|]. apply Rplus_le_compat; [|exact jerk_level].
    assert (Hb : 0 <= 2 * k_f * half_l1_norm k_f k_s * M) by (repeat apply Rmult_le_pos; lra).
    apply Rle_trans with (sqrt 3 * (2 * k_f * half_l1_norm k_f k_s * M)); [|lra].
    pose proof (jerk_of_an_axis _ _ _ bandwidths HM _ _ _ _ _ flown_x) as Jx.
    pose proof (jerk_of_an_axis _ _ _ bandwidths HM _ _ _ _ _ flown_y) as Jy.
    pose proof (jerk_of_an_axis _ _ _ bandwidths HM _ _ _ _ _ flown_z) as Jz. cbv beta in Jx, Jy, Jz.
    apply three_axes; try assumption; components; now rewrite Ropp_mult_distr_l_reverse.
  - unfold command_2, snap_bound. eapply Rle_trans; [apply triangle|]. apply Rplus_le_compat; [|exact snap_level].
    set (U := half_l1_norm k_f k_s) in *.
    assert (HU : k_f * (U * U) <= k_f * U).
    { apply Rmult_le_compat_l; [lra|]. rewrite <- (Rmult_1_r U) at 3. apply Rmult_le_compat_l; lra. }
    assert (Hkm : 0 <= 2 * k_f * M) by (repeat apply Rmult_le_pos; lra).
    assert (HkU : 0 <= k_f * U) by (apply Rmult_le_pos; lra).
    assert (Hb : 0 <= 2 * k_f * M * (k_f * U + k_s)) by (apply Rmult_le_pos; lra).
    apply Rle_trans with (sqrt 3 * (2 * k_f * M * (k_f * U + k_s))); [|lra].
    assert (Hle : 2 * k_f * M * (k_s + k_f * (U * U)) <= 2 * k_f * M * (k_f * U + k_s))
      by (apply Rmult_le_compat_l; lra).
    pose proof (snap_of_an_axis _ _ _ bandwidths HM _ _ _ _ _ flown_x input_x) as Sx.
    pose proof (snap_of_an_axis _ _ _ bandwidths HM _ _ _ _ _ flown_y input_y) as Sy.
    pose proof (snap_of_an_axis _ _ _ bandwidths HM _ _ _ _ _ flown_z input_z) as Sz. cbv beta in Sx, Sy, Sz.
    apply three_axes; [exact Hb | | |]; components; (eapply Rle_trans; [|exact Hle]); assumption.
Qed.

Let omega := omega command command_1 nu nu_1.
Let omega_1 := omega_1 command command_1 nu nu_1 t command_2 nu_2.

Lemma vertical_least_positive : 0 < vertical_least.
Proof. unfold vertical_least. lra. Qed.

(** Lemma 1; no derivatives of the filters at t are needed, so it holds of the
    formulas where the input jumps, too. *)
Theorem lemma_1 :
  length (omega t) <= omega_bound jerk_bound vertical_least horizontal_greatest K_nu_1 /\
  length omega_1 <= omega_1_bound jerk_bound snap_bound vertical_least horizontal_greatest K_nu_1 K_nu_2.
Proof.
  destruct command_levels as (L1 & L2 & L3 & L4). pose proof vertical_least_positive as Hz.
  apply desired_rates_bounded; assumption.
Qed.

(** Where it does not jump, the one is the other's derivative. *)
Theorem rates_in_flight : moves omega t omega_1.
Proof.
  destruct command_moves as (M1 & M2). destruct command_levels as (L1 & _). pose proof vertical_least_positive.
  apply omega_moves; try assumption. lra.
Qed.

End Flown.
